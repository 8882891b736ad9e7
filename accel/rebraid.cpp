#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/instance_leaf.h>
#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/rebraid.h>
#include <rayloom/accel/structure.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>

namespace rayloom::accel {
namespace {

Box box_of(const PrimitiveRef& ref) {
  Box box;
  box.extend(ref.min, ref.max);
  return box;
}

Box common_part(const Box& a, const Box& b) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = std::max(a.min[k], b.min[k]);
    box.max[k] = std::min(a.max[k], b.max[k]);
  }
  return box;
}

bool meet(const Box& box) { return box.min[0] <= box.max[0] && box.min[1] <= box.max[1] && box.min[2] <= box.max[2]; }

/// Tells how much of a box the other instances cover.
class Overlaps {
 public:
  explicit Overlaps(PrimitiveRefs refs) : refs_(std::move(refs)), tree_(build_binary_tree(refs_, {1, refs_.size()})) {}

  /// Half areas of the parts that `ref` has in common with the boxes of other instances, summed; at most its own.
  double operator()(const PrimitiveRef& ref) const {
    const Box box = box_of(ref);
    const double most = box.half_area();
    double sum = 0;
    std::vector<uint32_t> pending{0};
    while (!pending.empty() && sum < most) {
      const uint32_t slot = pending.back();
      pending.pop_back();
      const BinaryNode& node = tree_[slot];
      const Box part = common_part(box, node.box);
      if (!meet(part)) continue;
      if (!node.is_leaf()) {
        pending.push_back(node.right);
        pending.push_back(slot + 1);
      } else if (refs_[node.first].primitive != ref.primitive) {
        sum += part.half_area();
      }
    }
    return std::min(sum, most);
  }

 private:
  PrimitiveRefs refs_;
  BinaryTree tree_;
};

struct Opening {
  double gain;
  PrimitiveRef ref;
  /// Ties go by name, so that the order is total.
  bool operator<(const Opening& other) const {
    if (gain != other.gain) return gain < other.gain;
    return name_less(other.ref, ref);
  }
};

/// The references that an opened one is replaced by.
struct Children {
  uint32_t count = 0;
  std::array<PrimitiveRef, 8> refs;
  double area() const {
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i) sum += box_of(refs[i]).half_area();
    return sum;
  }
};

class Rebraiding {
 public:
  Rebraiding(PrimitiveRefs refs, std::span<const InstanceDesc> instances, AddressSpace addresses, uint64_t budget)
      : instances_(instances), addresses_(addresses), overlaps_(refs), left_(budget - refs.size()) {
    std::vector<double> gains(refs.size());
    parallel_for(refs.size(), 64, [&](uint64_t begin, uint64_t end) {
      for (uint64_t i = begin; i < end; ++i) gains[i] = is_well_conditioned(refs[i]) ? gain(refs[i]) : 0;
    });
    for (size_t i = 0; i < refs.size(); ++i) add(refs[i], gains[i]);
  }

  PrimitiveRefs run() {
    while (!openings_.empty() && left_ > 0) {
      std::pop_heap(openings_.begin(), openings_.end());
      const PrimitiveRef ref = openings_.back().ref;
      openings_.pop_back();
      open(ref);
    }
    for (const Opening& opening : openings_) done_.push_back(opening.ref);
    return std::move(done_);
  }

 private:
  /// A part that shares less of its box with others had better stay in one piece.
  static constexpr double least_shared = 0.25;
  /// Openings may raise the expected number of entries by this factor, since rays end before they meet them all.
  /// Measured: without a limit, turned elongated instances are traced at 0.6 of the speed of unopened ones.
  static constexpr double most_area = 1.3;

  /// How much opening is worth, in areas; 0: nothing.
  double gain(const PrimitiveRef& ref) const {
    if (node_ref::is_leaf(ref.geometry) || refers_to_lazy(ref)) return 0;
    const double area = box_of(ref).half_area(), gained = most_area * area - children_of(ref).area();
    return gained > 0 && overlaps_(ref) >= least_shared * area ? gained : 0;
  }

  /// Those stay in one piece: their leaves may be parts that are not built.
  bool refers_to_lazy(const PrimitiveRef& ref) const {
    return is_lazy(header_of(addresses_.host(instances_[ref.primitive].bottom_level_address)));
  }

  void add(const PrimitiveRef& ref, double gained) {
    if (gained <= 0) return done_.push_back(ref);
    openings_.push_back({gained, ref});
    std::push_heap(openings_.begin(), openings_.end());
  }

  /// Boxes of ill-conditioned instances are opened to all of space.
  bool is_well_conditioned(const PrimitiveRef& ref) const {
    return conditioning(instances_[ref.primitive]) <= max_conditioning;
  }

  void open(const PrimitiveRef& ref) {
    const Children children = children_of(ref);
    if (children.count == 0 || children.count - 1 > left_) return done_.push_back(ref);
    left_ -= children.count - 1;
    for (uint32_t i = 0; i < children.count; ++i) add(children.refs[i], gain(children.refs[i]));
  }

  Children children_of(const PrimitiveRef& ref) const {
    const InstanceDesc& desc = instances_[ref.primitive];
    const std::byte* const block = addresses_.host(desc.bottom_level_address);
    const uint32_t entry = ref.geometry != 0 ? ref.geometry : header_of(block).root;
    const auto& node = *reinterpret_cast<const Node8*>(block + node_ref::offset(entry));
    Children children;
    for (int i = 0; i < 8; ++i) {
      Box box;
      for (int k = 0; k < 3; ++k) {
        box.min[k] = node.bounds[k][0][i];
        box.max[k] = node.bounds[k][1][i];
      }
      if (!box.empty())
        children.refs[children.count++] =
            make_primitive_ref(world_box(desc.transform, box), node.child[i], ref.primitive);
    }
    return children;
  }

  std::span<const InstanceDesc> instances_;
  AddressSpace addresses_;
  Overlaps overlaps_;
  uint64_t left_;
  std::vector<Opening> openings_;  ///< a heap
  PrimitiveRefs done_;
};

}  // namespace

PrimitiveRefs rebraid(PrimitiveRefs refs, std::span<const InstanceDesc> instances, AddressSpace addresses,
                      uint64_t budget) {
  return Rebraiding(std::move(refs), instances, addresses, budget).run();
}

}  // namespace rayloom::accel
