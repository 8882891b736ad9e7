#pragma once

// A progress bar with rate and time left on standard error. It shows itself only on a terminal, only once work has run
// for two seconds, and at most four times a second; otherwise it costs one atomic addition an advance().

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace rayloom {

class Progress {
 public:
  /// `label`: what is being done. `total`: units of work. `unit`: their name in the rate ("rays", "pixels").
  /// `file`: descriptor to draw on, standard error by default.
  Progress(std::string label, uint64_t total, std::string unit, int file = 2);
  ~Progress();  ///< removes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// From any thread.
  void advance(uint64_t units = 1) noexcept;
  uint64_t completed() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bar's line, without control characters, at most `columns` wide:
/// "render [#######-------------]  35 % 1.2 Mrays/s, 12 s left".
std::string progress_line(std::string_view label, uint64_t completed, uint64_t total, std::string_view unit,
                          double seconds, unsigned columns);

}  // namespace rayloom
