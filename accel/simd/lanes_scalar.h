#pragma once

// The lane tests in plain C++: the oracle of lanes-inl.h, bit for bit, and the kernel of CPUs without AVX2.

#include <rayloom/accel/depth_interval.h>
#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/simd/lane_masks.h>
#include <rayloom/accel/triangle_hit.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rayloom::accel::scalar {

/// What all rays share of a structure's bounds; see prepare_ray().
struct BoundsLanes {
  BoundsLanes(const StructureHeader& of, float scale) : header(&of), pad_scale(scale) {}
  const StructureHeader* header;
  float pad_scale;
};

inline void prepare_lanes(const Ray& ray, const BoundsLanes& bounds, PreparedRay& out) {
  out = prepare_ray(ray, bounds.header->bounds_min, bounds.header->bounds_max, bounds.pad_scale);
}

inline void object_ray_lanes(const InstanceRecord& instance, const Ray& ray, Ray& out) {
  out = object_ray(instance, ray);
}

/// What box tests and triangle tests read of a ray. In the SIMD twin these are vectors, here the prepared ray serves as
/// it is.
struct BoxLanes {
  explicit BoxLanes(const PreparedRay& prepared) : ray(&prepared) {}
  const PreparedRay* ray;
};
struct TriangleLanes {
  explicit TriangleLanes(const PreparedRay& prepared) : ray(&prepared) {}
  const PreparedRay* ray;
};

/// Entry and exit of box `lane` of bounds[axis][side][lane], clipped to [t_near, t_far], as the bits of floats; entry >
/// exit: missed. Signed integers compare like the floats whose bits they are where one of the two is not negative,
/// which t_near makes every entry and what a ray meets makes every exit; they take a quarter of the time.
struct BoxInterval {
  int32_t entry, exit;
};

inline int32_t plane_crossed(float plane, float reciprocal, float offset) {
  return std::bit_cast<int32_t>(std::fma(plane, reciprocal, offset));
}

inline BoxInterval box_interval(const PreparedRay& ray, const float (&bounds)[3][2][8], int lane, float t_near,
                                float t_far) {
  int32_t entry = std::bit_cast<int32_t>(t_near), exit = std::bit_cast<int32_t>(t_far);
  for (int k = 0; k < 3; ++k) {
    const float* const planes = &bounds[0][0][lane];
    entry = std::max(entry, plane_crossed(planes[ray.near_row[k]], ray.reciprocal[k], ray.near_offset[k]));
    exit = std::min(exit, plane_crossed(planes[ray.far_row(k)], ray.reciprocal[k], ray.far_offset[k]));
  }
  return {entry, exit};
}

/// The children whose boxes the ray may meet. Their entry distances are rounded down to multiples of eight units in the
/// last place, so that the vector twin can sort them together with the lane in the low three bits; those of other lanes
/// hold no meaning.
struct NodeHits {
  uint32_t mask = 0;
  float near[8];
  void store_near(float (&out)[8]) const { std::copy_n(near, 8, out); }
};

inline float round_entry(int32_t entry) { return std::bit_cast<float>(entry & ~7); }

/// Boxes met in [t_near, t_far], both in box space: near_limit(), far_limit().
inline NodeHits test_node(const BoxLanes& lanes, const Node8& node, float t_near, float t_far) {
  NodeHits hits;
  for (int lane = 0; lane < 8; ++lane) {
    const BoxInterval interval = box_interval(*lanes.ray, node.bounds, lane, t_near, t_far);
    hits.near[lane] = round_entry(interval.entry);
    hits.mask |= uint32_t{interval.entry <= interval.exit} << lane;
  }
  return hits;
}

/// Mask of the used procedural boxes the ray may meet. Conservative: DXR lets an intersection shader run for more.
inline uint32_t test_boxes(const BoxLanes& lanes, const ProceduralLeaf8& leaf, float t_near, float t_far) {
  uint32_t mask = 0;
  for (int lane = 0; lane < 8; ++lane) {
    const BoxInterval interval = box_interval(*lanes.ray, leaf.bounds, lane, t_near, t_far);
    mask |= uint32_t{interval.entry <= interval.exit && leaf.primitive[lane] != no_index} << lane;
  }
  return mask;
}

/// The three edge functions of a triangle in the ray's sheared frame (01, 12, 20), a bound on the error of each, and
/// the depths between which the triangle lies.
struct EdgeFilter {
  float edge[3];
  float bound;
  float z[3];  ///< depths of the vertices along the ray
  float near, far, depth;

  bool missed() const {
    const bool some_above = edge[0] > bound || edge[1] > bound || edge[2] > bound;
    const bool some_below = edge[0] < -bound || edge[1] < -bound || edge[2] < -bound;
    return some_above && some_below;
  }
  bool hit() const {
    const bool all_above = edge[0] > bound && edge[1] > bound && edge[2] > bound;
    const bool all_below = edge[0] < -bound && edge[1] < -bound && edge[2] < -bound;
    return all_above || all_below;
  }
};

inline float flip(float value, float sign) {
  return std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ std::bit_cast<uint32_t>(sign));
}

// MAXPS and MINPS, which return the second operand when the operands are unordered or equal.
inline float max_lane(float a, float b) { return a > b ? a : b; }
inline float min_lane(float a, float b) { return a < b ? a : b; }

inline EdgeFilter filter_triangle(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane, float sign) {
  float x[3], y[3], z[3];
  for (uint32_t i = 0; i < 3; ++i) {
    z[i] = leaf.coordinate(i, ray.axis[2], lane) - ray.origin[ray.axis[2]];
    x[i] = std::fma(-ray.shear[0], z[i], leaf.coordinate(i, ray.axis[0], lane) - ray.origin[ray.axis[0]]);
    y[i] = std::fma(-ray.shear[1], z[i], leaf.coordinate(i, ray.axis[1], lane) - ray.origin[ray.axis[1]]);
  }
  const float extent =
      ((std::fabs(x[0]) + std::fabs(y[0])) + (std::fabs(x[1]) + std::fabs(y[1]))) + (std::fabs(x[2]) + std::fabs(y[2]));
  const float depths[] = {flip(z[0], sign), flip(z[1], sign), flip(z[2], sign)};
  const float near = min_lane(min_lane(depths[0], depths[1]), depths[2]);
  const float far = max_lane(max_lane(depths[0], depths[1]), depths[2]);
  const float depth = max_lane(far, -near);
  // docs/numerics.md, "The float filter": the unscaled product overflows before any product of an edge function can.
  const float product = std::fma(0x1p-21f, depth, extent) * std::fma(1.625f, extent, 3.125f * depth);
  return {{std::fma(x[0], y[1], -(y[0] * x[1])), std::fma(x[1], y[2], -(y[1] * x[2])),
           std::fma(x[2], y[0], -(y[2] * x[0]))},
          std::fma(product, 0x1p-24f, 0x1p-126f),
          {depths[0], depths[1], depths[2]},
          near,
          far,
          depth};
}

/// Depths of certain hits times the areas of their triangles, from below, and these areas from above.
struct LeafDepths {
  float low[8], most[8];
};

/// The lanes whose certain hits lie beyond DepthInterval::outer_far.
inline uint32_t depths_beyond(const LeafDepths& depths, float outer_far) {
  uint32_t lanes = 0;
  for (uint32_t lane = 0; lane < 8; ++lane) lanes |= uint32_t{depths.low[lane] > outer_far * depths.most[lane]} << lane;
  return lanes;
}

/// Depths of certain hits, good enough to tell which to look at first.
inline void store_nearest(const LeafDepths& depths, float (&nearest)[8]) {
  for (uint32_t lane = 0; lane < 8; ++lane) nearest[lane] = depths.low[lane] / depths.most[lane];
}

/// Whether the depth of a certain hit is outside the interval, or inside it. docs/numerics.md, "Depths".
struct DepthOfHit {
  bool outside, inside;
  float low, most;  ///< of LeafDepths
};

inline DepthOfHit depth_of_hit(const EdgeFilter& filter, const DepthInterval& depths) {
  const auto& [edge, bound, z, near, far, depth] = filter;
  const float signed_area = (edge[0] + edge[1]) + edge[2];
  const float sum = std::fma(edge[0], z[2], std::fma(edge[2], z[1], edge[1] * z[0]));
  const float area = std::fabs(signed_area), distance = flip(sum, std::copysign(0.0f, signed_area));
  const float margin = 4 * bound;
  const float reach = 2 * depth * area;  // infinite if any part of the sum is
  const float error = std::fma(reach, 0x1p-22f, std::fma(depth, margin, 0x1p-120f));
  const float most = area + margin, least = area - margin;
  const float low = distance - error, high = distance + error;
  return {high < depths.outer_near * least || low > depths.outer_far * most,
          low > depths.inner_near * most && high < depths.inner_far * least, low, most};
}

inline LeafMasks test_triangles(const TriangleLanes& lanes, const TriangleLeaf& leaf, const DepthInterval& depths,
                                LeafDepths& found) {
  LeafMasks masks;
  found = {};
  for (uint32_t lane = 0; lane < leaf.count; ++lane) {
    const EdgeFilter filter = filter_triangle(*lanes.ray, leaf, lane, depths.sign);
    if (filter.missed() || filter.near > depths.outer_far || filter.far < depths.outer_near) continue;
    const bool hit = filter.hit();
    const DepthOfHit depth = depth_of_hit(filter, depths);
    found.low[lane] = depth.low;
    found.most[lane] = depth.most;
    if (hit && depth.outside) continue;
    masks.possible |= 1u << lane;
    masks.certain |= uint32_t{hit} << lane;
    masks.inside |= uint32_t{hit && depth.inside} << lane;
  }
  return masks;
}

inline LeafMasks test_triangles(const TriangleLanes& lanes, const TriangleLeaf& leaf, const DepthInterval& depths) {
  LeafDepths found;
  return test_triangles(lanes, leaf, depths, found);
}

/// The hit with a triangle of a leaf that the ray's line certainly hits, if it is in range.
inline std::optional<TriangleHit> hit_lane(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane,
                                           float t_far) {
  float v[3][3];
  for (uint32_t vertex = 0; vertex < 3; ++vertex)
    for (uint32_t axis = 0; axis < 3; ++axis) v[vertex][axis] = leaf.coordinate(vertex, axis, lane);
  return finish_triangle(ray, v[0], v[1], v[2], t_far);
}

}  // namespace rayloom::accel::scalar
