#pragma once

#include <rayloom/accel/chunks.h>
#include <rayloom/accel/primitive_ref.h>

namespace rayloom::accel {

/// Appends in parallel what fill(chunk, begin, end, out) writes for the chunks of primitives 0..count-1, at most one
/// item a primitive; it returns the end of what it wrote. An exception of the lowest chunk that throws comes through.
template <class Item, class Fill>
void append_chunks(ScratchVector<Item>& items, uint64_t count, const Fill& fill) {
  const size_t base = items.size();
  items.resize(base + count);
  std::vector<size_t> kept(chunk_count(count));
  for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) {
    Item* const out = items.data() + base + begin;
    kept[chunk] = static_cast<size_t>(fill(chunk, begin, end, out) - out);
  });
  Item* end = items.data() + base;
  for (size_t chunk = 0; chunk < kept.size(); ++chunk) {
    const Item* first = items.data() + base + chunk * chunk_size;
    if (end != first) std::copy(first, first + kept[chunk], end);
    end += kept[chunk];
  }
  items.resize(static_cast<size_t>(end - items.data()));
}

/// Appends make_ref(primitive), a std::optional<PrimitiveRef>, of primitives 0..count-1 in order, in parallel, leaving
/// out the empty ones. An exception of the lowest primitive that throws comes through.
template <class MakeRef>
void append_refs(PrimitiveRefs& refs, uint64_t count, const MakeRef& make_ref) {
  append_chunks(refs, count, [&](size_t, size_t begin, size_t end, PrimitiveRef* out) {
    for (size_t i = begin; i < end; ++i)
      if (const auto ref = make_ref(static_cast<uint32_t>(i))) *out++ = *ref;
    return out;
  });
}

}  // namespace rayloom::accel
