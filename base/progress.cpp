#include <rayloom/base/progress.h>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>

namespace rayloom {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto silent_time = std::chrono::seconds(2);
constexpr auto redraw_interval = std::chrono::milliseconds(250);

bool is_terminal(int file) {
  const char* const terminal = std::getenv("TERM");
  return isatty(file) == 1 && terminal != nullptr && std::strcmp(terminal, "dumb") != 0;
}

bool wants_color() {
  const char* const no_color = std::getenv("NO_COLOR");  // no-color.org: set and not empty
  return no_color == nullptr || *no_color == 0;
}

unsigned terminal_columns(int file) {
  winsize size = {};
  return ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col != 0 ? size.ws_col : 80u;
}

/// 1234567 -> "1.23 M"
std::string with_si_prefix(double value) {
  constexpr std::array prefixes = {"", "k", "M", "G", "T"};
  std::size_t i = 0;
  while (value >= 1000 && i + 1 < prefixes.size()) value /= 1000, ++i;
  return fmt::format("{:.3g} {}", value, prefixes[i]);
}

std::string duration(double seconds) {
  const auto whole = static_cast<uint64_t>(std::min(seconds, 1e9));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progress_line(std::string_view label, uint64_t completed, uint64_t total, std::string_view unit,
                          double seconds, unsigned columns) {
  constexpr unsigned bar_width = 20;
  const double part = total == 0 ? 1.0 : std::min(1.0, static_cast<double>(completed) / static_cast<double>(total));
  const double rate = seconds > 0 ? static_cast<double>(completed) / seconds : 0.0;
  const auto filled = static_cast<unsigned>(part * bar_width);
  std::string line = fmt::format("{} [{:#<{}}{:-<{}}] {:3.0f} % {}{}/s", label, "", filled, "", bar_width - filled,
                                 part * 100, with_si_prefix(rate), unit);
  if (rate > 0) line += fmt::format(", {} left", duration(static_cast<double>(total) * (1 - part) / rate));
  if (line.size() > columns) line.resize(columns);
  return line;
}

struct Progress::State {
  void draw(Clock::time_point now) {
    const std::chrono::duration<double> run = now - begin;
    const std::string line =
        progress_line(label, completed.load(), total, unit, run.count(), terminal_columns(file) - 1);
    send(color ? fmt::format("\r\x1b[2m{}\x1b[0m\x1b[K", line) : fmt::format("\r{}\x1b[K", line));
    shown = true;
  }
  void send(std::string_view text) {
    [[maybe_unused]] const auto written = ::write(file, text.data(), text.size());  // a lost bar is no error
  }

  std::string label;
  uint64_t total;
  std::string unit;
  int file;
  bool active = is_terminal(file);
  bool color = wants_color();
  Clock::time_point begin = Clock::now();
  std::atomic<uint64_t> completed = 0;
  std::atomic<Clock::rep> next = (begin + silent_time).time_since_epoch().count();
  std::mutex drawing = {};
  bool shown = false;
};

Progress::Progress(std::string label, uint64_t total, std::string unit, int file)
    : state_(new State{std::move(label), total, std::move(unit), file}) {}

Progress::~Progress() {
  if (state_->shown) state_->send("\r\x1b[K");
}

void Progress::advance(uint64_t units) noexcept {
  state_->completed.fetch_add(units, std::memory_order_relaxed);
  if (!state_->active) return;
  const auto now = Clock::now();
  if (now.time_since_epoch().count() < state_->next.load(std::memory_order_relaxed)) return;
  const std::unique_lock lock(state_->drawing, std::try_to_lock);
  if (!lock || now.time_since_epoch().count() < state_->next.load(std::memory_order_relaxed)) return;
  state_->next.store((now + redraw_interval).time_since_epoch().count(), std::memory_order_relaxed);
  try {
    state_->draw(now);
  } catch (...) {  // out of memory for a bar: go without
  }
}

uint64_t Progress::completed() const noexcept { return state_->completed.load(std::memory_order_relaxed); }

}  // namespace rayloom
