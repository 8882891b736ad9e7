#pragma once

// The steps that updates of both levels share.

#include <rayloom/accel/build.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/refit_tree.h>

#include <cstring>

namespace rayloom::accel {

/// Throws InputError unless `source` may be updated into `result` by a build of this kind, count and settings: UP-01,
/// UP-02, BF-01, BF-06.
void check_update(const std::byte* source, std::span<const std::byte> result, StructureKind kind, uint64_t primitives,
                  uint64_t geometries, const BuildSettings& settings);

/// Copies the source's bytes, unless it is updated in place, and returns the new header.
StructureHeader begin_update(const std::byte* source, std::byte* result, const BuildSettings& settings);

/// Enters what the leaves came to, and writes the header. Returns the structure's bytes.
uint64_t end_update(const Refitted& root, StructureHeader header, std::byte* result);

/// The whole of it, after check_update().
template <class RefitLeaf>
uint64_t update(const std::byte* source, std::byte* result, const BuildSettings& settings,
                const RefitLeaf& refit_leaf) {
  const StructureHeader header = begin_update(source, result, settings);
  if (header.root == no_index) return end_update({}, header, result);
  return end_update(TreeRefit<RefitLeaf>(result, refit_leaf).node(header.root), header, result);
}

}  // namespace rayloom::accel
