#pragma once

// HLSL's Interlocked functions on 32-bit elements of writable views: atomic between all lanes of a dispatch. They
// return the value before (HLSL's optional `original_value`). An element out of range reads 0 and stays as it is. A
// tracer sees a load and a store.

#include <rayloom/runtime/buffer_views.h>

#include <atomic>
#include <concepts>

namespace rayloom {

template <class T>
concept InterlockedElement = std::same_as<T, uint32_t> || std::same_as<T, int32_t>;

namespace detail {
/// Runs `change` (old -> new) atomically; returns the old value.
template <InterlockedElement T, class Change>
T interlocked(uint64_t address, Change change) {
  const ShaderMemory& memory = shader_memory;
  std::byte* const host = address % sizeof(T) == 0 ? memory.host(address, sizeof(T)) : nullptr;
  if (!host) return T{};
  std::atomic_ref<T> element(*reinterpret_cast<T*>(host));
  T before = element.load(std::memory_order_relaxed);
  while (!element.compare_exchange_weak(before, change(before), std::memory_order_relaxed)) {
  }
  if (memory.observer) [[unlikely]] {
    const T after = change(before);
    memory.observer->tracer->access(memory.observer->lane, AccessKind::load, address, sizeof(T), nullptr);
    memory.observer->tracer->access(memory.observer->lane, AccessKind::store, address, sizeof(T), &after);
  }
  return before;
}
template <InterlockedElement T>
T wrapping_add(T a, T b) {
  return static_cast<T>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}
}  // namespace detail

template <InterlockedElement T>
T InterlockedAdd(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return detail::wrapping_add(old, value); });
}
template <InterlockedElement T>
T InterlockedMin(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return value < old ? value : old; });
}
template <InterlockedElement T>
T InterlockedMax(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return old < value ? value : old; });
}
template <InterlockedElement T>
T InterlockedAnd(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return old & value; });
}
template <InterlockedElement T>
T InterlockedOr(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return old | value; });
}
template <InterlockedElement T>
T InterlockedXor(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return old ^ value; });
}
template <InterlockedElement T>
T InterlockedExchange(const detail::ElementReference<T>& element, std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T) { return value; });
}
template <InterlockedElement T>
T InterlockedCompareExchange(const detail::ElementReference<T>& element, std::type_identity_t<T> compare,
                             std::type_identity_t<T> value) {
  return detail::interlocked<T>(element.address(), [=](T old) { return old == compare ? value : old; });
}

}  // namespace rayloom
