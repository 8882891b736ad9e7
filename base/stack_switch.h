#pragma once

// Leaves one stack for another. On x86-64 with GCC's inline assembly this takes eight instructions: no call and no
// return, so that the processor's stack of return addresses stays right for lanes that do the same thing one after
// another. Elsewhere Boost.Context's fcontext does it. Only fiber.cpp uses this.

#include <cstddef>
#include <cstdint>

#if defined(__x86_64__) && !defined(RAYLOOM_STACK_SWITCH_BY_BOOST)
#define RAYLOOM_STACK_SWITCH_BY_BOOST 0
#else
#undef RAYLOOM_STACK_SWITCH_BY_BOOST
#define RAYLOOM_STACK_SWITCH_BY_BOOST 1
#include <boost/context/detail/fcontext.hpp>
#endif

namespace rayloom::detail {

using StackEntry = void (*)(void* argument);  // never returns

#if RAYLOOM_STACK_SWITCH_BY_BOOST

/// Where a suspended stack goes on.
struct StackPoint {
  boost::context::detail::fcontext_t context = nullptr;
  StackEntry entry = nullptr;
};

/// What travels with a jump: who left, and what a new stack's entry is given.
struct StackTransfer {
  StackPoint* left;
  StackEntry entry;
  void* argument;
};

inline void land(boost::context::detail::transfer_t from) {
  static_cast<StackTransfer*>(from.data)->left->context = from.fctx;
}

/// A stack of `bytes` below `top` that begins with entry(argument) when it is first switched to.
inline StackPoint make_stack(void* top, std::size_t bytes, StackEntry entry) {
  const auto begin = [](boost::context::detail::transfer_t from) {
    const StackTransfer transfer = *static_cast<StackTransfer*>(from.data);
    land(from);
    transfer.entry(transfer.argument);
  };
  return {boost::context::detail::make_fcontext(top, bytes, begin), entry};
}

/// Suspends the running stack in `here` and goes on at `there`; returns when someone switches to `here`.
inline void switch_stack(StackPoint& here, const StackPoint& there, void* argument) {
  StackTransfer transfer{&here, there.entry, argument};
  land(boost::context::detail::jump_fcontext(there.context, &transfer));
}

#else

struct StackPoint {
  void* stack = nullptr;
  void* frame = nullptr;
  void* instruction = nullptr;
};

inline StackPoint make_stack(void* top, std::size_t, StackEntry entry) {
  // As if called: a return address of null, at which a debugger's walk ends, and the alignment a call leaves behind.
  auto* const slot = reinterpret_cast<void**>(reinterpret_cast<uintptr_t>(top) / 16 * 16) - 1;
  *slot = nullptr;
  return {slot, nullptr, reinterpret_cast<void*>(entry)};
}

#if defined(__AVX512F__)
#define RAYLOOM_WIDE_REGISTERS                                                                                  \
  , "xmm16", "xmm17", "xmm18", "xmm19", "xmm20", "xmm21", "xmm22", "xmm23", "xmm24", "xmm25", "xmm26", "xmm27", \
      "xmm28", "xmm29", "xmm30", "xmm31", "k1", "k2", "k3", "k4", "k5", "k6", "k7"
#else
#define RAYLOOM_WIDE_REGISTERS
#endif

// Whatever the compiler has in registers it must save itself: all are named as overwritten. The frame pointer cannot
// be, so it is kept with the stack pointer.
[[gnu::always_inline]] inline void switch_stack(StackPoint& here, const StackPoint& there, void* argument) {
  StackPoint* left = &here;
  const StackPoint* target = &there;
  asm volatile(
      "movq %%rsp, 0(%[left])\n\t"
      "movq %%rbp, 8(%[left])\n\t"
      "leaq 1f(%%rip), %%rax\n\t"
      "movq %%rax, 16(%[left])\n\t"
      "movq 0(%[target]), %%rsp\n\t"
      "movq 8(%[target]), %%rbp\n\t"
      "jmpq *16(%[target])\n\t"
      "1:\n\t"
      : [left] "+d"(left), [target] "+S"(target), "+D"(argument)
      :
      : "rax", "rbx", "rcx", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "xmm0", "xmm1", "xmm2", "xmm3",
        "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "xmm9", "xmm10", "xmm11", "xmm12", "xmm13", "xmm14", "xmm15", "memory",
        "cc" RAYLOOM_WIDE_REGISTERS);
}
#undef RAYLOOM_WIDE_REGISTERS

#endif

}  // namespace rayloom::detail
