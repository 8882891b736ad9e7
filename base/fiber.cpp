#include <rayloom/base/fiber.h>

#include <rayloom/base/float_environment.h>

#include <boost/context/detail/fcontext.hpp>
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

#if defined(__has_feature)
#define RAYLOOM_HAS_FEATURE(name) __has_feature(name)
#else
#define RAYLOOM_HAS_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || RAYLOOM_HAS_FEATURE(address_sanitizer)
#define RAYLOOM_ASAN 1
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif
#if defined(__SANITIZE_THREAD__) || RAYLOOM_HAS_FEATURE(thread_sanitizer)
#define RAYLOOM_TSAN 1
#include <sanitizer/tsan_interface.h>
#endif

namespace rayloom {

namespace {

using boost::context::detail::fcontext_t;
using boost::context::detail::jump_fcontext;
using boost::context::detail::make_fcontext;
using boost::context::detail::transfer_t;

std::size_t page_bytes() {
  static const auto bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return bytes;
}

/// What the sanitizers want to hear around a switch: leave() just before the jump, arrive() just after it.
class SwitchAnnotations {
 public:
  SwitchAnnotations([[maybe_unused]] const void* stack, [[maybe_unused]] std::size_t bytes) {
#if RAYLOOM_ASAN
    own_stack_ = stack;
    own_bytes_ = bytes;
#endif
#if RAYLOOM_TSAN
    own_thread_ = __tsan_create_fiber(0);
#endif
  }
  ~SwitchAnnotations() {
#if RAYLOOM_TSAN
    __tsan_destroy_fiber(own_thread_);
#endif
  }
  SwitchAnnotations(const SwitchAnnotations&) = delete;
  SwitchAnnotations& operator=(const SwitchAnnotations&) = delete;

  void leave_caller() {
#if RAYLOOM_ASAN
    __sanitizer_start_switch_fiber(&caller_fake_stack_, own_stack_, own_bytes_);
#endif
#if RAYLOOM_TSAN
    caller_thread_ = __tsan_get_current_fiber();
    __tsan_switch_to_fiber(own_thread_, 0);
#endif
  }
  void arrive_in_fiber() {
#if RAYLOOM_ASAN
    __sanitizer_finish_switch_fiber(own_fake_stack_, &caller_stack_, &caller_bytes_);
#endif
  }
  void leave_fiber() {
#if RAYLOOM_ASAN
    __sanitizer_start_switch_fiber(&own_fake_stack_, caller_stack_, caller_bytes_);
#endif
#if RAYLOOM_TSAN
    __tsan_switch_to_fiber(caller_thread_, 0);
#endif
  }
  void arrive_in_caller() {
#if RAYLOOM_ASAN
    __sanitizer_finish_switch_fiber(caller_fake_stack_, nullptr, nullptr);
#endif
  }

 private:
#if RAYLOOM_ASAN
  const void* own_stack_ = nullptr;
  std::size_t own_bytes_ = 0;
  void* own_fake_stack_ = nullptr;
  const void* caller_stack_ = nullptr;
  std::size_t caller_bytes_ = 0;
  void* caller_fake_stack_ = nullptr;
#endif
#if RAYLOOM_TSAN
  void* own_thread_ = nullptr;
  void* caller_thread_ = nullptr;
#endif
};

}  // namespace

struct Fiber::Context {
  Context(std::byte* mapping, std::size_t mapped)
      : begin(mapping),
        bytes(mapped),
        valgrind_id(VALGRIND_STACK_REGISTER(begin + page_bytes(), this)),
        annotations(begin + page_bytes(), stack_bytes()),
        own(make_fcontext(this, stack_bytes(), &Context::entry)) {}
  ~Context() { VALGRIND_STACK_DEREGISTER(valgrind_id); }

  std::size_t stack_bytes() const {
    return static_cast<std::size_t>(reinterpret_cast<const std::byte*>(this) - begin) - page_bytes();
  }

  void resume() {
    annotations.leave_caller();
    own = jump_fcontext(own, this).fctx;
    annotations.arrive_in_caller();
  }
  void yield() {
    annotations.leave_fiber();
    caller = jump_fcontext(caller, nullptr).fctx;
    annotations.arrive_in_fiber();
  }

  /// First frame of the stack; never returns. A finished fiber waits here for its next function.
  static void entry(transfer_t from) {
    auto& self = *static_cast<Context*>(from.data);
    self.caller = from.fctx;
    self.annotations.arrive_in_fiber();
    for (;;) {
      FloatEnvironment::set();
      self.function(self.argument);
      self.done = true;
      self.yield();
    }
  }

  std::byte* begin;  // of the mapping: guard page, stack, this object
  std::size_t bytes;
  unsigned valgrind_id;
  SwitchAnnotations annotations;
  fcontext_t own;
  fcontext_t caller = nullptr;
  Function function = nullptr;
  void* argument = nullptr;
  bool done = true;
};

void Fiber::Unmap::operator()(Context* context) const {
  std::byte* const begin = context->begin;
  const std::size_t bytes = context->bytes;
  context->~Context();
#if RAYLOOM_ASAN
  __asan_unpoison_memory_region(begin, bytes);  // frames of an unfinished fiber leave poison behind
#endif
  munmap(begin, bytes);
}

Fiber::Fiber(std::size_t stack_bytes) {
  const std::size_t page = page_bytes();
  const std::size_t room = 64 * ((sizeof(Context) + 63) / 64);
  const std::size_t usable = (stack_bytes + room + page - 1) / page * page;
  void* const memory = mmap(nullptr, page + usable, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  auto* const begin = static_cast<std::byte*>(memory);
  if (mprotect(begin + page, usable, PROT_READ | PROT_WRITE) != 0) {
    munmap(begin, page + usable);
    throw std::bad_alloc();
  }
  context_.reset(new (begin + page + usable - room) Context(begin, page + usable));
}

Fiber::~Fiber() = default;
Fiber::Fiber(Fiber&&) noexcept = default;
Fiber& Fiber::operator=(Fiber&&) noexcept = default;

void Fiber::start(Function function, void* argument) {
  context_->function = function;
  context_->argument = argument;
  context_->done = false;
}
void Fiber::resume() { context_->resume(); }
void Fiber::yield() { context_->yield(); }
bool Fiber::done() const { return context_->done; }

}  // namespace rayloom
