#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace rayloom::accel {

/// Up to `capacity` objects for the time of a call, in memory that the thread keeps for its next call: a batch of a few
/// rays takes less time than malloc does with the tasks of one. Calls may nest: the inner one has memory of its own.
template <class T>
class KeptArray {
 public:
  explicit KeptArray(size_t capacity) : memory_(std::exchange(kept(), {})) {
    if (memory_.capacity < capacity) memory_ = Memory(capacity);
  }
  ~KeptArray() {
    clear();
    if (memory_.capacity > kept().capacity) kept() = std::move(memory_);
  }
  KeptArray(const KeptArray&) = delete;
  KeptArray& operator=(const KeptArray&) = delete;

  template <class... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    T* const place = begin() + size_++;
    if constexpr (sizeof...(Arguments) == 0)
      return *::new (static_cast<void*>(place)) T;  // does not clear a plain struct first
    else
      return *::new (static_cast<void*>(place)) T{std::forward<Arguments>(arguments)...};
  }
  void clear() { std::destroy_n(begin(), std::exchange(size_, 0)); }

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }
  /// Plain elements may be written here without being added.
  T* begin() { return reinterpret_cast<T*>(memory_.bytes.get()); }
  T* end() { return begin() + size_; }
  T& operator[](size_t i) { return begin()[i]; }

 private:
  struct Free {
    void operator()(std::byte* bytes) const { ::operator delete (bytes, std::align_val_t{alignof(T)}); }
  };
  struct Memory {
    Memory() = default;
    explicit Memory(size_t count)
        : bytes(static_cast<std::byte*>(::operator new (count * sizeof(T), std::align_val_t{alignof(T)}))),
          capacity(count) {}
    Memory(Memory&& other) noexcept : bytes(std::move(other.bytes)), capacity(std::exchange(other.capacity, 0)) {}
    Memory& operator=(Memory&& other) noexcept {
      bytes = std::move(other.bytes);
      capacity = std::exchange(other.capacity, 0);
      return *this;
    }
    std::unique_ptr<std::byte, Free> bytes;
    size_t capacity = 0;
  };
  static Memory& kept() {
    static thread_local Memory memory;
    return memory;
  }

  Memory memory_;
  size_t size_ = 0;
};

}  // namespace rayloom::accel
