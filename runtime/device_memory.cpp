#include <rayloom/base/error.h>
#include <rayloom/runtime/device_memory.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <sys/mman.h>

namespace rayloom {
namespace {

constexpr uint64_t huge_page_bytes = uint64_t{2} << 20;

std::byte* reserve(uint64_t bytes) {
  void* const memory = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<std::byte*>(memory);
}

uint64_t round_to_pages(uint64_t bytes) {
  return (bytes + DeviceMemory::page_bytes - 1) / DeviceMemory::page_bytes * DeviceMemory::page_bytes;
}

[[noreturn]] void fail(uint64_t bytes, const std::string& why) {
  throw InputError("device memory", "allocation of " + std::to_string(bytes) + " bytes", why);
}

}  // namespace

DeviceMemory::DeviceMemory(uint64_t bytes) : bytes_(round_to_pages(bytes < page_bytes ? page_bytes : bytes)) {
  const uint64_t wanted = bytes_;
  while (!(mapping_ = reserve(bytes_)) && bytes_ / 2 >= least_bytes) bytes_ = round_to_pages(bytes_ / 2);
  if (!mapping_)
    throw InputError("device memory", "address space of " + std::to_string(wanted) + " bytes",
                     std::string("cannot be reserved: ") + std::strerror(errno));
  const uint64_t flags = bytes_ / page_bytes + 1;
  void* const table = mmap(nullptr, flags, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (table == MAP_FAILED) {
    munmap(mapping_, bytes_);
    throw std::bad_alloc();
  }
  committed_ = static_cast<uint8_t*>(table);
}

DeviceMemory::~DeviceMemory() {
  munmap(committed_, bytes_ / page_bytes + 1);
  munmap(mapping_, bytes_);
}

/// First fit; every allocation is followed by a page that stays uncommitted.
uint64_t DeviceMemory::find_gap(uint64_t bytes) const {
  uint64_t offset = 0;
  for (const auto& [begin, size] : allocations_) {
    if (begin - offset >= bytes + page_bytes) break;
    offset = begin + size + page_bytes;
  }
  return offset;
}

uint64_t DeviceMemory::allocate(uint64_t bytes) {
  if (bytes > bytes_) fail(bytes, "the device has " + std::to_string(bytes_) + " bytes of addresses");
  const uint64_t size = round_to_pages(bytes == 0 ? 1 : bytes);
  const std::lock_guard lock(mutex_);
  const uint64_t offset = find_gap(size);
  if (offset > bytes_ || size > bytes_ - offset)
    fail(bytes, "no gap that large is left in " + std::to_string(bytes_) + " bytes of addresses");
  if (mprotect(mapping_ + offset, size, PROT_READ | PROT_WRITE) != 0)
    fail(bytes, std::string("the host has no memory for it: ") + std::strerror(errno));
  // Advice only: large structures in small pages spend half of a ray's time on address translation.
  if (size >= huge_page_bytes) madvise(mapping_ + offset, size, MADV_HUGEPAGE);
  allocations_.emplace(offset, size);
  std::memset(committed_ + offset / page_bytes, 1, size / page_bytes);
  return first_address + offset;
}

void DeviceMemory::free(uint64_t address) {
  const std::lock_guard lock(mutex_);
  const auto found = allocations_.find(address - first_address);
  if (found == allocations_.end()) return;
  const auto [offset, size] = *found;
  std::memset(committed_ + offset / page_bytes, 0, size / page_bytes);
  // A fresh mapping gives the pages back and makes the next owner's memory zero.
  mmap(mapping_ + offset, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
  allocations_.erase(found);
}

accel::AddressSpace DeviceMemory::addresses() const {
  return {reinterpret_cast<const std::byte*>(reinterpret_cast<uintptr_t>(mapping_) - first_address)};
}

bool DeviceMemory::holds(uint64_t address, uint64_t bytes) const {
  const uint64_t offset = address - first_address;
  if (offset >= bytes_ || bytes > bytes_ - offset) return false;
  const std::lock_guard lock(mutex_);
  auto next = allocations_.upper_bound(offset);
  if (next == allocations_.begin()) return false;
  --next;
  return offset - next->first <= next->second && bytes <= next->second - (offset - next->first);
}

detail::ShaderMemory DeviceMemory::shader_memory() const {
  return {reinterpret_cast<uintptr_t>(mapping_) - first_address, first_address, bytes_, committed_, nullptr};
}

}  // namespace rayloom
