#pragma once

// A range of device memory that frees itself. The host reads and writes it directly; shaders see it through views.

#include <rayloom/runtime/device_memory.h>
#include <rayloom/runtime/texture_views.h>

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace rayloom {

class Buffer {
 public:
  Buffer() = default;
  /// `bytes` zeroed bytes, starting at a multiple of 64 KiB.
  Buffer(std::shared_ptr<DeviceMemory> memory, uint64_t bytes)
      : memory_(std::move(memory)), address_(memory_->allocate(bytes)), bytes_(bytes) {}
  ~Buffer() { release(); }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }

  uint64_t address() const { return address_; }
  uint64_t bytes() const { return bytes_; }
  explicit operator bool() const { return memory_ != nullptr; }

  std::span<std::byte> host() const {
    return memory_ ? std::span<std::byte>(memory_->host(address_), bytes_) : std::span<std::byte>();
  }
  /// The whole buffer as an array of T (a rest smaller than T is left out).
  template <class T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(host().data()), bytes_ / sizeof(T)};
  }
  /// Both throw InputError when the range does not fit.
  template <class T>
  void upload(std::span<const T> data, uint64_t byte_offset = 0) const {
    write(byte_offset, data.data(), data.size_bytes());
  }
  template <class T>
  std::vector<T> download(uint64_t count, uint64_t byte_offset = 0) const {
    check(byte_offset, count * sizeof(T));
    std::vector<T> data(count);
    read(byte_offset, data.data(), count * sizeof(T));
    return data;
  }

  template <class T>
  StructuredBuffer<T> structured() const {
    return {address_, bytes_ / sizeof(T)};
  }
  template <class T>
  RWStructuredBuffer<T> rw_structured() const {
    return {address_, bytes_ / sizeof(T)};
  }
  ByteAddressBuffer byte_address() const { return {address_, bytes_}; }
  RWByteAddressBuffer rw_byte_address() const { return {{address_, bytes_}}; }
  template <class T>
  ConstantBuffer<T> constant() const {
    check(0, sizeof(T));
    return {address_};
  }
  template <class T>
  Texture2D<T> texture(uint width, uint height) const {
    check(0, uint64_t{width} * height * sizeof(T));
    return {address_, width, height};
  }
  template <class T>
  RWTexture2D<T> rw_texture(uint width, uint height) const {
    check(0, uint64_t{width} * height * sizeof(T));
    return {address_, width, height};
  }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(address_, other.address_);
    std::swap(bytes_, other.bytes_);
  }
  void release() noexcept {
    if (memory_) memory_->free(address_);
  }
  void check(uint64_t offset, uint64_t size) const;
  void write(uint64_t offset, const void* data, uint64_t size) const;
  void read(uint64_t offset, void* data, uint64_t size) const;

  std::shared_ptr<DeviceMemory> memory_;
  uint64_t address_ = 0;
  uint64_t bytes_ = 0;
};

}  // namespace rayloom
