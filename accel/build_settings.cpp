#include <rayloom/accel/build_settings.h>

#include <algorithm>
#include <iterator>

namespace rayloom::accel {
namespace {

constexpr Builder builders[] = {Builder::binned_sah, Builder::spatial_splits, Builder::lbvh, Builder::lbvh_treelets,
                                Builder::reinsertion};

}  // namespace

std::span<const Builder> all_builders() { return builders; }

const char* builder_name(Builder builder) {
  switch (builder) {
    case Builder::automatic:
      return "automatic";
    case Builder::binned_sah:
      return "binned_sah";
    case Builder::spatial_splits:
      return "spatial_splits";
    case Builder::lbvh:
      return "lbvh";
    case Builder::lbvh_treelets:
      return "lbvh_treelets";
    case Builder::reinsertion:
      return "reinsertion";
  }
  return "unknown";
}

std::optional<Builder> parse_builder(std::string_view name) {
  if (name == builder_name(Builder::automatic)) return Builder::automatic;
  const auto* const found =
      std::find_if(std::begin(builders), std::end(builders), [&](Builder b) { return name == builder_name(b); });
  return found == std::end(builders) ? std::nullopt : std::optional(*found);
}

}  // namespace rayloom::accel
