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

/// Returns the part's root.
uint32_t construct(std::byte* block, const LazyPart& part) {
  const LazyInput stored(block);
  const TriangleCurve order = stored.order(part.first, part.count);
  PartBuilder builder(order, stored.tree_input());
  const uint32_t root = builder.build_alone({0, 0, part.count, part.budget, lazy_first_depth});
  LazyState& state = lazy_state(block);
  const uint32_t place = std::atomic_ref(state.next_granule).fetch_add(builder.wide().granule());
  assert((uint64_t{place} + builder.wide().granule()) * granule_bytes + TriangleLeaf::overread_bytes <=
         state.geometries);
  builder.move_to(block, place);
  std::atomic_ref(state.built_count).fetch_add(1);
  return root + place;
}

/// Gives the others the part's root, or leave to try themselves.
void publish(LazyPart& part, uint32_t root) {
  std::atomic_ref(part.root).store(root, std::memory_order_release);
  std::atomic_ref(part.root).notify_all();
}

}  // namespace

uint32_t detail::build_lazy_part(std::byte* block, LazyPart& part) {
  const std::atomic_ref root(part.root);
  for (uint32_t seen = LazyPart::unbuilt; !root.compare_exchange_strong(seen, LazyPart::being_built);) {
    if (seen > LazyPart::being_built) return seen;
    if (seen == LazyPart::being_built) root.wait(seen);
    seen = LazyPart::unbuilt;
  }
  try {
    const uint32_t built = construct(block, part);
    publish(part, built);
    return built;
  } catch (const std::bad_alloc&) {
    publish(part, LazyPart::unbuilt);
    throw OutOfMemory();
  } catch (...) {
    publish(part, LazyPart::unbuilt);
    throw;
  }
}

}  // namespace rayloom::accel
