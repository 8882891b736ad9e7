#pragma once

// Re-braiding: Benthin, Woop, Wald, Afra, "Improved Two-Level BVHs using Partial Re-Braiding" (2017). Where instances
// overlap, a ray must enter all of them, whatever it hits first. Entered at several nodes instead of at its root, an
// instance is seen by the top level as several smaller boxes, which can be told apart and visited in order.

#include <rayloom/accel/build.h>
#include <rayloom/accel/primitive_ref.h>

namespace rayloom::accel {

/// References to nodes of the instances that `refs` (one an active instance) name, at most `budget` (not
/// fewer than refs.size()) of them: each leaf of an instance's tree lies below exactly one. Opens what overlaps other
/// instances, first where that saves most area. The same for any thread count.
PrimitiveRefs rebraid(PrimitiveRefs refs, std::span<const InstanceDesc> instances, AddressSpace addresses,
                      uint64_t budget);

}  // namespace rayloom::accel
