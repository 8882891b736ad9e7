#pragma once

#include <rayloom/accel/chunks.h>
#include <rayloom/accel/primitive_ref.h>

namespace rayloom::accel {

/// Appends make_ref(primitive), a std::optional<PrimitiveRef>, of primitives 0..count-1 in order, in parallel, leaving
/// out the empty ones. An exception of the lowest primitive that throws comes through.
template <class MakeRef>
void append_refs(PrimitiveRefs& refs, uint64_t count, const MakeRef& make_ref) {
  const size_t base = refs.size();
  refs.resize(base + count);
  std::vector<size_t> kept(chunk_count(count));
  for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) {
    PrimitiveRef* out = refs.data() + base + begin;
    for (size_t i = begin; i < end; ++i)
      if (const auto ref = make_ref(static_cast<uint32_t>(i))) *out++ = *ref;
    kept[chunk] = static_cast<size_t>(out - (refs.data() + base + begin));
  });
  PrimitiveRef* end = refs.data() + base;
  for (size_t chunk = 0; chunk < kept.size(); ++chunk) {
    const PrimitiveRef* first = refs.data() + base + chunk * chunk_size;
    if (end != first) std::copy(first, first + kept[chunk], end);
    end += kept[chunk];
  }
  refs.resize(static_cast<size_t>(end - refs.data()));
}

}  // namespace rayloom::accel
