#include <rayloom/hwmodel/shadow_memory.h>

namespace rayloom::hwmodel {

void ShadowMemory::store(uint64_t address, std::span<const std::byte> data) {
  Page* page = nullptr;
  for (const std::byte value : data) {
    const uint64_t offset = address % page_bytes;
    if (!page || offset == 0) page = &pages_[address / page_bytes];
    page->data[offset] = value;
    page->stored[offset] = true;
    ++address;
  }
}

// Calls function(index in the range, value) for each stored byte.
template <class Function>
void ShadowMemory::for_each_stored(uint64_t address, uint64_t bytes, Function&& function) const {
  const uint64_t end = address + bytes;
  auto page = pages_.lower_bound(address / page_bytes);
  for (; page != pages_.end() && page->first * page_bytes < end; ++page) {
    const uint64_t base = page->first * page_bytes;
    const uint64_t first = base < address ? address - base : 0;
    const uint64_t last = end - base < page_bytes ? end - base : page_bytes;
    for (uint64_t offset = first; offset < last; ++offset)
      if (page->second.stored[offset]) function(base + offset - address, page->second.data[offset]);
  }
}

void ShadowMemory::read(uint64_t address, std::span<std::byte> out) const {
  for_each_stored(address, out.size(), [&](uint64_t index, std::byte value) { out[index] = value; });
}

uint64_t ShadowMemory::bytes_stored(uint64_t address, uint64_t bytes) const {
  uint64_t count = 0;
  for_each_stored(address, bytes, [&](uint64_t, std::byte) { ++count; });
  return count;
}

}  // namespace rayloom::hwmodel
