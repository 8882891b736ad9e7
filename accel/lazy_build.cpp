#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/chunks.h>
#include <rayloom/accel/collapse.h>
#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/lazy_build.h>
#include <rayloom/accel/lazy_layout.h>
#include <rayloom/accel/loose_wide.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/subtree.h>
#include <rayloom/accel/triangle_curve.h>
#include <rayloom/base/error.h>

#include <cassert>
#include <cstring>

namespace rayloom::accel {
namespace {

struct Range {
  uint32_t first, count;
};

/// Cuts where codes change most, as the curve's tree does, until parts are small enough.
void cut_on_curve(std::span<const MortonKey> keys, const Range& range, std::vector<Range>& parts) {
  if (range.count <= lazy_part_size) return parts.push_back(range);
  const uint32_t change = detail::change_of(keys.subspan(range.first, range.count));
  const uint32_t left = change != 0 ? change : range.count / 2;
  cut_on_curve(keys, {range.first, left}, parts);
  cut_on_curve(keys, {range.first + left, range.count - left}, parts);
}

std::vector<Range> cut_evenly(size_t keys) {
  std::vector<Range> parts;
  for (size_t first = 0; first < keys; first += lazy_part_size)
    parts.push_back(
        {static_cast<uint32_t>(first), static_cast<uint32_t>(std::min<size_t>(lazy_part_size, keys - first))});
  return parts;
}

/// At most most_lazy_parts().
std::vector<Range> cut_into_parts(std::span<const MortonKey> keys) {
  std::vector<Range> parts;
  cut_on_curve(keys, {0, static_cast<uint32_t>(keys.size())}, parts);
  return parts.size() <= most_lazy_parts(keys.size()) ? parts : cut_evenly(keys.size());
}

/// References to parts, numbered as their primitives.
PrimitiveRefs part_refs(const TriangleCurve& order, const std::vector<Range>& parts) {
  PrimitiveRefs refs(parts.size());
  parallel_for(parts.size(), 16, [&](uint64_t begin, uint64_t end) {
    PrimitiveRefs triangles(lazy_part_size);
    for (uint64_t i = begin; i < end; ++i) {
      order.gather(order.keys().subspan(parts[i].first, parts[i].count), triangles.data());
      const Box box = bounds_of(std::span(triangles).first(parts[i].count)).box;
      refs[i] = make_primitive_ref(box, 0, static_cast<uint32_t>(i));
    }
  });
  return refs;
}

BinaryTree tree_above(PrimitiveRefs& refs) {
  const auto count = static_cast<uint32_t>(refs.size());
  PrimitiveRefs scratch(count);
  BinaryTree tree(2 * size_t{count} - 1);
  build_binary_subtree(refs, scratch, 1, {0, 0, count, count, lazy_first_depth}, tree);
  return tree;
}

class LazyBuild {
 public:
  LazyBuild(const TriangleCurve& order, const LazyLayout& layout, const BuildSettings& settings, std::byte* block)
      : order_(order),
        geometries_(order.numbers().geometries()),
        layout_(layout),
        block_(block),
        parts_(cut_into_parts(order.keys())) {
    write_state();
    write_parts(settings);
    std::memcpy(block + layout.keys, order.keys().data(), order.keys().size_bytes());
    copy_geometries();
  }

  void write_tree(StructureHeader& header) const {
    PrimitiveRefs refs = part_refs(order_, parts_);
    const BinaryTree tree = tree_above(refs);
    WideBytes wide;
    wide.start(block_, granule(layout_.nodes));
    LooseWide root = wide.add_below(tree, Collapse(tree), 0, [&](uint32_t slot, LooseWide& node, uint32_t) {
      node.push(tree[slot].box, granule(part_place(refs[tree[slot].first].primitive)) | node_ref::leaf_bit);
      return 1u;
    });
    header.lazy_root = wide.add_node(root);
    header.first_part = granule(layout_.parts);
    header.part_count = static_cast<uint32_t>(parts_.size());
    assert(uint64_t{wide.granule()} * granule_bytes <= layout_.built);
    header.depth = root.depth + 1;
    header.node_count = static_cast<uint32_t>(wide.nodes().size());
    header.leaf_count = static_cast<uint32_t>(parts_.size());
    std::copy_n(tree[0].box.min, 3, header.bounds_min);
    std::copy_n(tree[0].box.max, 3, header.bounds_max);
  }

 private:
  static uint32_t granule(uint64_t place) { return static_cast<uint32_t>(place / granule_bytes); }
  uint64_t part_place(uint32_t part) const { return layout_.parts + part * sizeof(LazyPart); }

  void write_state() const {
    LazyState state{order_.curve(), layout_.geometries, layout_.keys, 0, 0, granule(layout_.built)};
    state.key_count = static_cast<uint32_t>(order_.keys().size());
    std::memcpy(&lazy_state(block_), &state, sizeof(state));
  }

  void write_parts(const BuildSettings& settings) const {
    for (uint32_t i = 0; i < parts_.size(); ++i) {
      const uint64_t budget = part_leaf_budget(parts_[i].count, settings);
      const LazyPart part{parts_[i].first, parts_[i].count, static_cast<uint32_t>(budget), {}};
      std::memcpy(block_ + part_place(i), &part, sizeof(part));
    }
    std::memset(block_ + part_place(static_cast<uint32_t>(parts_.size())), 0, TriangleLeaf::overread_bytes);
    std::memset(block_ + LazyLayout::roots, 0, parts_.size() * sizeof(uint32_t));
    static_assert(part_unbuilt == 0);
  }

  void copy_geometries() const {
    uint64_t place = layout_.buffers;
    for (size_t g = 0; g < geometries_.size(); ++g) {
      const TriangleGeometry& geometry = geometries_[g];
      LazyGeometry copy{};
      copy.vertices = place;
      copy.indices = place + 12 * copied_vertices(geometry);
      copy.vertex_count = static_cast<uint32_t>(copied_vertices(geometry));
      copy.triangle_count = geometry.triangle_count;
      copy.flags = geometry.flags;
      copy.index_format = copies_unindexed(geometry) ? IndexFormat::none : geometry.index_format;
      std::memcpy(block_ + layout_.geometries + g * sizeof(copy), &copy, sizeof(copy));
      copy_vertices(geometry, block_ + copy.vertices);
      copy_indices(geometry, block_ + copy.indices);
      place = copy.indices + (copied_index_bytes(geometry) + 3) / 4 * 4;
    }
  }

  static void copy_vertices(const TriangleGeometry& geometry, std::byte* to) {
    for_each_chunk(copied_vertices(geometry), [&](size_t, size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        float point[3];
        read_vertex(geometry, copied_vertex(geometry, i), point);
        std::memcpy(to + 12 * i, point, sizeof(point));
      }
    });
  }

  static uint32_t copied_vertex(const TriangleGeometry& geometry, size_t i) {
    if (!copies_unindexed(geometry)) return static_cast<uint32_t>(i);
    return read_indices(geometry, static_cast<uint32_t>(i / 3))[i % 3];
  }

  static void copy_indices(const TriangleGeometry& geometry, std::byte* to) {
    const uint64_t bytes = copied_index_bytes(geometry);
    if (bytes > 0) std::memcpy(to, geometry.indices, bytes);
  }

  const TriangleCurve& order_;
  std::span<const TriangleGeometry> geometries_;
  const LazyLayout& layout_;
  std::byte* block_;
  std::vector<Range> parts_;
};

}  // namespace

bool builds_lazily(const BuildSettings& settings) {
  if (!(settings.flags & build_flag::lazy)) return false;
  if (settings.flags & build_flag::allow_update)
    throw InputError("acceleration structure build", "flags",
                     "a lazy build cannot allow updates, which change triangles that may not be built yet");
  return true;
}

void build_lazily(std::span<const TriangleGeometry> geometries, const BuildSettings& settings, StructureHeader& header,
                  std::byte* block) {
  const TriangleCurve order(geometries, false);
  if (order.keys().empty()) return;
  const LazyLayout layout = lazy_layout(geometries, settings);
  LazyBuild(order, layout, settings, block).write_tree(header);
  header.active_count = order.keys().size();
  header.bytes = layout.bytes;
}

}  // namespace rayloom::accel
