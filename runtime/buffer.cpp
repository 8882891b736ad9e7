#include <rayloom/base/error.h>
#include <rayloom/runtime/buffer.h>

#include <cstring>
#include <string>

namespace rayloom {

void Buffer::check(uint64_t offset, uint64_t size) const {
  if (offset <= bytes_ && size <= bytes_ - offset) return;
  throw InputError("Buffer", "",
                   std::to_string(size) + " bytes at offset " + std::to_string(offset) + " do not fit into " +
                       std::to_string(bytes_) + " bytes");
}

void Buffer::write(uint64_t offset, const void* data, uint64_t size) const {
  check(offset, size);
  if (size) std::memcpy(host().data() + offset, data, size);
}

void Buffer::read(uint64_t offset, void* data, uint64_t size) const {
  check(offset, size);
  if (size) std::memcpy(data, host().data() + offset, size);
}

}  // namespace rayloom
