#include <rayloom/runtime/validation_log.h>

namespace rayloom::detail {

void ValidationLog::add(std::string_view row, uint64_t lane, std::string text, ValidationSeverity severity) {
  if (!enabled()) return;
  const std::lock_guard lock(mutex_);
  const auto [found, inserted] = entries_.try_emplace(row, Entry{lane, {row, severity, {}, 0}});
  Entry& entry = found->second;
  ++entry.message.count;
  // Reports of one lane arrive in order: the first stays.
  if (!inserted && lane >= entry.lane) return;
  entry.lane = lane;
  entry.message.text = std::move(text);
}

void ValidationLog::flush() {
  for (const auto& [row, entry] : entries_) callback_(entry.message);
  entries_.clear();
}

}  // namespace rayloom::detail
