#include <rayloom/accel/scratch_vector.h>

#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace rayloom::accel::detail {
namespace {

constexpr size_t huge_page = size_t{2} << 20;

bool takes_huge_pages(size_t bytes) { return bytes >= huge_page; }

}  // namespace

void* allocate_scratch(size_t bytes) {
  if (!takes_huge_pages(bytes)) return ::operator new(bytes);
  void* const memory = ::operator new (bytes, std::align_val_t{huge_page});
#if defined(__linux__)
  madvise(memory, bytes, MADV_HUGEPAGE);  // a hint: failure costs time only
#endif
  return memory;
}

void free_scratch(void* memory, size_t bytes) {
  if (takes_huge_pages(bytes))
    ::operator delete (memory, std::align_val_t{huge_page});
  else
    ::operator delete(memory);
}

}  // namespace rayloom::accel::detail
