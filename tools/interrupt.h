#pragma once

// Ctrl-C asks long work to stop at its next safe point; a second one ends the process at once. Files are written whole
// or not at all (base/output_file.h), so neither leaves half of one.

#include <exception>

namespace rayloom::tools {

/// Thrown at a safe point after Ctrl-C when there is nothing worth keeping.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Watches for Ctrl-C; and lets a file past its size limit be a failed write rather than the end of the process.
void set_up_signals();
bool interrupt_requested() noexcept;
void throw_if_interrupted();

}  // namespace rayloom::tools
