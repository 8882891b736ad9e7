#include <rayloom/tools/bench/peer_embree.h>

namespace rayloom::bench {

std::string describe(const EmbreeOptions& options) {
  static constexpr const char* names[]{"low", "medium", "high"};
  std::string text = names[static_cast<size_t>(options.quality)];
  if (options.robust) text += " robust";
  if (options.compact) text += " compact";
  return text;
}

}  // namespace rayloom::bench
