#include <rayloom/base/fiber_context.h>

#include <rayloom/base/stack_memory.h>

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

Fiber::Context::Context(std::byte* memory, std::size_t memory_bytes, std::byte* stack_top)
    : begin(memory),
      bytes(memory_bytes),
      valgrind_id(VALGRIND_STACK_REGISTER(memory, stack_top)),
      own(stack_top, static_cast<std::size_t>(stack_top - memory), &Context::entry) {}

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

void Fiber::GiveBack::operator()(Context* context) const {
  std::byte* const begin = context->begin;
  const std::size_t bytes = context->bytes;
  context->~Context();
#if RAYLOOM_ASAN
  __asan_unpoison_memory_region(begin, bytes);  // frames of an unfinished fiber leave poison behind
#endif
  detail::give_back_stack(begin, bytes);
}

Fiber::Fiber(std::size_t stack_bytes, std::size_t color) {
  constexpr std::size_t line = 64, lines_a_color = 17;
  const std::size_t page = detail::page_bytes();
  const std::size_t room = line * ((sizeof(Context) + line - 1) / line);
  const std::size_t unused = color * lines_a_color * line % page;
  const std::size_t bytes = (stack_bytes + page + room + page - 1) / page * page;  // of any color
  std::byte* const begin = detail::take_stack(bytes);
  std::byte* const top = begin + bytes - unused - room;
  context_.reset(new (top) Context(begin, bytes, top));
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
