#pragma once

// Gathers validation messages of a dispatch from all its warps and tells each row once, the same for any thread count.

#include <rayloom/runtime/validation.h>

#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace rayloom::detail {

class ValidationLog {
 public:
  explicit ValidationLog(const ValidationCallback& callback) : callback_(callback) {}

  bool enabled() const { return static_cast<bool>(callback_); }
  /// `row` is a literal. `lane`: linear index of the offender; the lowest one's text is kept.
  void add(std::string_view row, uint64_t lane, std::string text,
           ValidationSeverity severity = ValidationSeverity::error);
  /// Calls back for every row, in the order of their ids, and forgets them.
  void flush();

 private:
  struct Entry {
    uint64_t lane;
    ValidationMessage message;
  };

  const ValidationCallback& callback_;
  std::map<std::string_view, Entry> entries_;
  std::mutex mutex_;
};

}  // namespace rayloom::detail
