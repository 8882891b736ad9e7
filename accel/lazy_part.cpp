#include <rayloom/accel/lazy_input.h>
#include <rayloom/accel/lazy_part.h>
#include <rayloom/accel/part_builder.h>

#include <cassert>
#include <new>

namespace rayloom::accel {
namespace {

class OutOfMemory : public std::bad_alloc {
 public:
  const char* what() const noexcept override {
    return "acceleration structure: out of memory while a part of a lazy structure is built for a ray";
  }
};

/// Between parts: what filters read beyond one's last leaf is never written while they may.
constexpr uint32_t gap = TriangleLeaf::overread_bytes / granule_bytes;

/// Returns the part's root.
uint32_t construct(std::byte* block, uint32_t index) {
  const auto* const parts = block + uint64_t{header_of(block).first_part} * granule_bytes;
  const LazyPart& part = reinterpret_cast<const LazyPart*>(parts)[index];
  const LazyInput stored(block);
  const TriangleCurve order = stored.order(part.first, part.count);
  PartBuilder builder(order, stored.tree_input());
  const Subtree all{0, 0, part.count, part.budget, lazy_first_depth};
  builder.plan(all);
  PartBytes bytes;
  bytes.start_apart(all);
  const uint32_t root = builder.write_alone(bytes);
  LazyState& state = lazy_state(block);
  const uint32_t granules = bytes.wide.granule() + gap;
  const uint32_t place = std::atomic_ref(state.next_granule).fetch_add(granules);
  assert((uint64_t{place} + granules) * granule_bytes <= state.geometries);
  bytes.move_to(block, place);
  std::atomic_ref(state.built_count).fetch_add(1);
  return root + place;
}

/// Gives the others the part's root, or leave to try themselves.
void publish(std::atomic_ref<uint32_t> place, uint32_t root) {
  place.store(root, std::memory_order_release);
  place.notify_all();
}

}  // namespace

uint32_t detail::build_lazy_part(std::byte* block, uint32_t part) {
  const std::atomic_ref<uint32_t> root = root_of_part(block, part);
  for (uint32_t seen = part_unbuilt; !root.compare_exchange_strong(seen, part_being_built);) {
    if (seen > part_being_built) return seen;
    if (seen == part_being_built) root.wait(seen);
    seen = part_unbuilt;
  }
  try {
    const uint32_t built = construct(block, part);
    publish(root, built);
    return built;
  } catch (const std::bad_alloc&) {
    publish(root, part_unbuilt);
    throw OutOfMemory();
  } catch (...) {
    publish(root, part_unbuilt);
    throw;
  }
}

}  // namespace rayloom::accel
