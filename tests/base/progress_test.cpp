#include <rayloom/base/parallel.h>
#include <rayloom/base/progress.h>

#include <catch2/catch.hpp>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

using namespace rayloom;

namespace {

/// A terminal whose screen side the test reads.
class Terminal {
 public:
  Terminal() { REQUIRE(openpty(&reader_, &writer_, nullptr, nullptr, nullptr) == 0); }
  ~Terminal() {
    close(reader_);
    close(writer_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  int file() const { return writer_; }
  std::string output() const {
    std::string text;
    pollfd ready = {reader_, POLLIN, 0};
    while (poll(&ready, 1, 50) == 1) {
      char buffer[1024];
      const ssize_t count = read(reader_, buffer, sizeof buffer);
      if (count <= 0) break;
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  int reader_ = -1, writer_ = -1;
};

unsigned count_of(const std::string& text, const std::string& part) {
  unsigned count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("a progress line tells share, rate and time left", "[progress]") {
  CHECK(progress_line("render", 0, 100, "pixels", 0, 80) == "render [--------------------]   0 % 0 pixels/s");
  CHECK(progress_line("render", 25'000'000, 100'000'000, "rays", 10, 80) ==
        "render [#####---------------]  25 % 2.5 Mrays/s, 30 s left");
  CHECK(progress_line("render", 1, 1000, "tiles", 10, 80) ==
        "render [--------------------]   0 % 0.1 tiles/s, 2 h 46 min left");
  CHECK(progress_line("render", 100, 100, "pixels", 200, 80) ==
        "render [####################] 100 % 0.5 pixels/s, 0 s left");
}

TEST_CASE("a progress line keeps to the terminal's width and survives odd totals", "[progress]") {
  CHECK(progress_line("render", 50, 100, "rays", 1, 20).size() == 20);
  CHECK(progress_line("empty", 0, 0, "rays", 1, 80).find("100 %") != std::string::npos);
  CHECK(progress_line("more", 20, 10, "rays", 1, 80).find("100 %") != std::string::npos);
}

TEST_CASE("nothing is drawn where standard error is no terminal", "[progress]") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  {
    Progress progress("work", 10, "steps", ends[1]);
    std::this_thread::sleep_for(std::chrono::milliseconds(2100));
    progress.advance(5);
    CHECK(progress.completed() == 5);
  }
  close(ends[1]);
  char byte;
  CHECK(read(ends[0], &byte, 1) == 0);
  close(ends[0]);
}

TEST_CASE("on a terminal the bar waits two seconds, keeps to four a second and is removed", "[progress]") {
  setenv("TERM", "xterm", 1);
  setenv("NO_COLOR", "1", 1);
  const Terminal terminal;
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  double end = 0;
  {
    Progress progress("work", 1000, "steps", terminal.file());
    while (seconds() < 1.5) {
      progress.advance();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    CHECK(terminal.output().empty());
    while (seconds() < 3) {
      parallel_for(4, 1, [&](uint64_t, uint64_t) { progress.advance(); });
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    end = seconds();
  }
  const std::string output = terminal.output();
  const unsigned draws = count_of(output, "work [");
  CHECK(draws >= 1);
  CHECK(draws <= static_cast<unsigned>((end - 2) * 4) + 1);
  CHECK(output.find("\x1b[2m") == std::string::npos);
  CHECK(output.substr(output.size() - 4) == "\r\x1b[K");
}
