#include <rayloom/accel/build_input.h>
#include <rayloom/accel/close_box.h>
#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/structure.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

/// What the boxes below a node span along a row of a transform.
class SpanBelow {
 public:
  SpanBelow(const float (&row)[4], const std::byte* block) : row_(row), block_(block) {}

  Interval operator()(uint32_t root, int levels) {
    look_below(root, levels);
    return found_;
  }

 private:
  /// As image() computes them. Those of empty slots, whose boxes are infinite and inverted, are empty or NaN.
  struct Images {
    double low[8], high[8];
  };

  Images images_of(const Node8& node) const {
    Images out;
    std::fill_n(out.low, 8, double{row_[3]});
    std::fill_n(out.high, 8, double{row_[3]});
    for (int k = 0; k < 3; ++k) {
      const double factor = row_[k];
      const float *const first = node.bounds[k][factor < 0], *const last = node.bounds[k][!(factor < 0)];
      for (int i = 0; i < 8; ++i) out.low[i] += factor * double{first[i]};
      for (int i = 0; i < 8; ++i) out.high[i] += factor * double{last[i]};
    }
    return out;
  }

  /// Children that reach farthest come first: then most others need no look.
  void look_below(uint32_t ref, int levels) {
    const auto& node = *reinterpret_cast<const Node8*>(block_ + node_ref::offset(ref));
    const Images images = images_of(node);
    int lowest = 0, highest = 0;
    for (int i = 1; i < 8; ++i) {
      lowest = images.low[i] < images.low[lowest] ? i : lowest;
      highest = images.high[i] > images.high[highest] ? i : highest;
    }
    const auto look_into = [&](int i) { this->look_into(node.child[i], {images.low[i], images.high[i]}, levels); };
    look_into(lowest);
    look_into(highest);
    for (int i = 0; i < 8; ++i) {
      if (i != lowest && i != highest) look_into(i);
    }
  }

  void look_into(uint32_t child, const Interval& whole, int levels) {
    if (!(whole.low < found_.low || whole.high > found_.high)) return;
    if (levels > 1 && !node_ref::is_leaf(child)) return look_below(child, levels - 1);
    found_.low = std::min(found_.low, whole.low);
    found_.high = std::max(found_.high, whole.high);
  }

  const float (&row_)[4];
  const std::byte* block_;
  Interval found_;
};

/// Whether a row looks along one axis of the object: then nothing spans less than the bounds.
bool is_straight(const float (&row)[4]) { return (row[0] != 0) + (row[1] != 0) + (row[2] != 0) <= 1; }

}  // namespace

// Each level gives less: rays for shadows in a forest enter 4.81 instances with none, 4.32, 4.12, 4.03 and 4.01 with
// one to four, and a top level of 4001 instances takes 2.6, 2.9, 4.0, 6.7 and 10.9 ms to build.
int box_levels(const BuildSettings& settings) {
  if (settings.flags & build_flag::prefer_fast_build) return 0;
  return settings.flags & build_flag::prefer_fast_trace ? 3 : 2;
}

Box close_world_box(const float (&m)[3][4], const std::byte* block, int levels) {
  const StructureHeader& header = header_of(block);
  Box object_box;
  object_box.extend(header.bounds_min, header.bounds_max);
  const bool has_nodes = !is_lazy(header) && header.root != no_index && !node_ref::is_leaf(header.root);
  if (!has_nodes || levels == 0) return world_box(m, object_box);
  const auto span = [&](const float(&row)[4]) {
    return is_straight(row) ? image(row, object_box) : SpanBelow(row, block)(header.root, levels);
  };
  return widened_box(m, object_box, {span(m[0]), span(m[1]), span(m[2])});
}

}  // namespace rayloom::accel
