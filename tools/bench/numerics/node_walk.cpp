#include <rayloom/accel/box.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/structure.h>
#include <rayloom/tools/bench/numerics/node_walk.h>

namespace rayloom::bench::numerics {
namespace {

using accel::Box;

class EnclosureCheck {
 public:
  explicit EnclosureCheck(const std::byte* block) : block_(block) {}

  EnclosureCount check() {
    const accel::StructureHeader& header = accel::header_of(block_);
    if (header.root != accel::no_index) content(header.root);
    if (measured_ > 0) count_.excess_area = excess_ / measured_;
    return count_;
  }

 private:
  /// The exact box of everything below a reference.
  Box content(uint32_t ref) {
    const std::byte* address = block_ + accel::node_ref::offset(ref);
    if (accel::node_ref::is_leaf(ref)) return leaf(*reinterpret_cast<const accel::ProceduralLeaf8*>(address));
    const auto& node = *reinterpret_cast<const accel::Node8*>(address);
    Box whole;
    for (int i = 0; i < 8; ++i) {
      Box stored;
      for (int k = 0; k < 3; ++k) stored.min[k] = node.bounds[k][0][i], stored.max[k] = node.bounds[k][1][i];
      if (stored.min[0] > stored.max[0]) continue;
      const Box inner = content(node.child[i]);
      compare(stored, inner);
      whole.extend(inner);
    }
    return whole;
  }

  static Box leaf(const accel::ProceduralLeaf8& leaf) {
    Box box;
    for (int lane = 0; lane < 8; ++lane) {
      if (leaf.primitive[lane] == accel::no_index) continue;
      const auto& b = leaf.bounds;
      box.extend({b[0][0][lane], b[1][0][lane], b[2][0][lane]}, {b[0][1][lane], b[1][1][lane], b[2][1][lane]});
    }
    return box;
  }

  void compare(const Box& stored, const Box& inner) {
    ++count_.children;
    bool encloses = true;
    for (int k = 0; k < 3; ++k) encloses &= stored.min[k] <= inner.min[k] && inner.max[k] <= stored.max[k];
    count_.not_enclosed += !encloses;
    if (!(inner.half_area() > 0)) return;
    excess_ += stored.half_area() / inner.half_area() - 1;
    ++measured_;
  }

  const std::byte* block_;
  EnclosureCount count_;
  double excess_ = 0, measured_ = 0;
};

}  // namespace

EnclosureCount check_enclosure(const std::byte* block) { return EnclosureCheck(block).check(); }

}  // namespace rayloom::bench::numerics
