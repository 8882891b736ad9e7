#include <rayloom/base/fiber_context.h>

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <new>

#if __has_include(<valgrind/valgrind.h>)
#include <valgrind/valgrind.h>
#else
#define VALGRIND_STACK_REGISTER(begin, end) 0u
#define VALGRIND_STACK_DEREGISTER(id) static_cast<void>(id)
#endif
#if RAYLOOM_ASAN
#include <sanitizer/asan_interface.h>
#endif

namespace rayloom {

namespace {

std::size_t page_bytes() {
  static const auto bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return bytes;
}

}  // namespace

Fiber::Context::Context(std::byte* mapping, std::size_t mapped, std::byte* stack_bottom, std::byte* stack_top)
    : begin(mapping),
      bytes(mapped),
      valgrind_id(VALGRIND_STACK_REGISTER(stack_bottom, stack_top)),
      own(stack_top, static_cast<std::size_t>(stack_top - stack_bottom), &Context::entry) {}

Fiber::Context::~Context() { VALGRIND_STACK_DEREGISTER(valgrind_id); }

void Fiber::Context::entry(void* argument) {
  auto& self = *static_cast<Context*>(argument);
  self.own.known.arrive();
  self.own.arrive_in_own_modes();
  for (;;) {
    self.function(self.argument);
    self.done = true;
    self.yield();
  }
}

void Fiber::Unmap::operator()(Context* context) const {
  std::byte* const begin = context->begin;
  const std::size_t bytes = context->bytes;
  context->~Context();
#if RAYLOOM_ASAN
  __asan_unpoison_memory_region(begin, bytes);  // frames of an unfinished fiber leave poison behind
#endif
  munmap(begin, bytes);
}

Fiber::Fiber(std::size_t stack_bytes, std::size_t color) {
  constexpr std::size_t line = 64, lines_a_color = 17;
  const std::size_t page = page_bytes();
  const std::size_t room = line * ((sizeof(Context) + line - 1) / line);
  const std::size_t unused = color * lines_a_color * line % page;
  const std::size_t usable = (stack_bytes + unused + room + page - 1) / page * page;
  void* const memory = mmap(nullptr, page + usable, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  auto* const begin = static_cast<std::byte*>(memory);
  if (mprotect(begin + page, usable, PROT_READ | PROT_WRITE) != 0) {
    munmap(begin, page + usable);
    throw std::bad_alloc();
  }
  std::byte* const top = begin + page + usable - unused - room;
  context_.reset(new (top) Context(begin, page + usable, begin + page, top));
}

Fiber::~Fiber() = default;
Fiber::Fiber(Fiber&&) noexcept = default;
Fiber& Fiber::operator=(Fiber&&) noexcept = default;

void Fiber::start(Function function, void* argument) {
  context_->function = function;
  context_->argument = argument;
  context_->own.modes = FloatModes::fixed();
  context_->done = false;
}
void Fiber::resume() { context_->resume(); }
void Fiber::yield() { context_->yield(); }
void Fiber::yield_to(Fiber& next) { context_->yield_to(*next.context_); }
bool Fiber::done() const { return context_->done; }

}  // namespace rayloom
