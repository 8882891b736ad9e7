#include <rayloom/tools/interrupt.h>

#include <csignal>

namespace rayloom::tools {
namespace {

volatile std::sig_atomic_t requested = 0;

extern "C" void on_interrupt(int) {
  requested = 1;
  std::signal(SIGINT, SIG_DFL);
}

}  // namespace

void set_up_signals() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupt_requested() noexcept { return requested != 0; }

void throw_if_interrupted() {
  if (interrupt_requested()) throw Interrupted();
}

}  // namespace rayloom::tools
