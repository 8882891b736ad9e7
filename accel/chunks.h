#pragma once

// Parallel reductions whose result does not depend on the number of threads: chunk boundaries follow from the count
// alone and parts are merged in chunk order.

#include <rayloom/base/parallel.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rayloom::accel {

inline constexpr size_t chunk_size = size_t{1} << 14;

inline size_t chunk_count(size_t count) { return (count + chunk_size - 1) / chunk_size; }

/// Calls body(chunk, begin, end) for every chunk of [0, count).
template <class Body>
void for_each_chunk(size_t count, const Body& body) {
  parallel_for(chunk_count(count), 1, [&](size_t first, size_t last) {
    for (size_t chunk = first; chunk < last; ++chunk)
      body(chunk, chunk * chunk_size, std::min(count, (chunk + 1) * chunk_size));
  });
}

/// Sum of map(begin, end) over the chunks of [0, count); T has merge(const T&) and an empty default.
template <class T, class Map>
T reduce_chunks(size_t count, const Map& map) {
  if (count <= chunk_size) return map(size_t{0}, count);
  std::vector<T> parts(chunk_count(count));
  for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) { parts[chunk] = map(begin, end); });
  T total;
  for (const T& part : parts) total.merge(part);
  return total;
}

}  // namespace rayloom::accel
