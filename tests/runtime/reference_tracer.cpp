#include "reference_tracer.h"

#include <rayloom/accel/layout.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

namespace rayloom::test {
namespace {

using namespace accel;

struct Vector {
  double x, y, z;
};
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

template <class Header>
const Header& at(const std::byte* block, uint64_t offset) {
  return *reinterpret_cast<const Header*>(block + offset);
}

/// All leaves of a structure, wherever they are.
std::vector<const std::byte*> leaves(const std::byte* block) {
  std::vector<const std::byte*> found;
  std::vector<uint32_t> pending;
  if (const uint32_t root = at<StructureHeader>(block, 0).root; root != no_index) pending.push_back(root);
  while (!pending.empty()) {
    const uint32_t ref = pending.back();
    pending.pop_back();
    if (node_ref::is_leaf(ref)) {
      found.push_back(block + node_ref::offset(ref));
      continue;
    }
    const Node8& node = at<Node8>(block, node_ref::offset(ref));
    for (int i = 0; i < 8; ++i)
      if (node.bounds[0][0][i] <= node.bounds[0][1][i]) pending.push_back(node.child[i]);
  }
  return found;
}

struct Primitive {
  uint32_t geometry, flags, primitive;
  Vector vertex[3];  // triangles only
};

void collect_triangles(const std::byte* block, std::vector<Primitive>& primitives) {
  for (const std::byte* address : leaves(block)) {
    const auto& leaf = at<TriangleLeaf>(address, 0);
    for (uint32_t lane = 0; lane < leaf.count; ++lane) {
      Primitive item{leaf.geometry_of(lane) & 0xFFFFFF, leaf.geometry_of(lane) >> 24, leaf.primitive[lane], {}};
      for (uint32_t v = 0; v < 3; ++v)
        item.vertex[v] = {leaf.coordinate(v, 0, lane), leaf.coordinate(v, 1, lane), leaf.coordinate(v, 2, lane)};
      primitives.push_back(item);
    }
  }
}

void collect_boxes(const std::byte* block, std::vector<Primitive>& primitives) {
  for (const std::byte* address : leaves(block)) {
    const auto& leaf = at<ProceduralLeaf8>(address, 0);
    for (int lane = 0; lane < 8; ++lane) {
      if (leaf.primitive[lane] == no_index) continue;
      primitives.push_back({leaf.geometry[lane] & 0xFFFFFF, leaf.geometry[lane] >> 24, leaf.primitive[lane], {}});
    }
  }
}

std::vector<Primitive> primitives_of(const std::byte* block) {
  std::vector<Primitive> primitives;
  if (at<StructureHeader>(block, 0).kind == StructureKind::triangles)
    collect_triangles(block, primitives);
  else
    collect_boxes(block, primitives);
  std::sort(primitives.begin(), primitives.end(), [](const Primitive& a, const Primitive& b) {
    return std::tie(a.geometry, a.primitive) < std::tie(b.geometry, b.primitive);
  });
  return primitives;
}

struct Found {
  double t, u, v;
  bool front;
};

/// The ray against the closed triangle (Moeller and Trumbore 1997).
std::optional<Found> intersect(const Vector& origin, const Vector& direction, const Primitive& triangle) {
  const Vector e1 = triangle.vertex[1] - triangle.vertex[0], e2 = triangle.vertex[2] - triangle.vertex[0];
  const Vector p = cross(direction, e2), s = origin - triangle.vertex[0], q = cross(s, e1);
  const double determinant = dot(e1, p);
  if (determinant == 0) return std::nullopt;
  const double u = dot(s, p) / determinant, v = dot(direction, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  return Found{dot(e2, q) / determinant, u, v, dot(cross(e1, e2), direction) < 0};
}

class Search {
 public:
  Search(AddressSpace addresses, const TraceRequest& request) : addresses_(addresses), request_(request) {
    hit_.t = request.ray.t_max;
  }

  Hit run() {
    if (!request_.structure || !is_valid(request_.ray)) return hit_;
    std::vector<const InstanceRecord*> instances;
    for (const std::byte* leaf : leaves(request_.structure)) instances.push_back(&at<InstanceRecord>(leaf, 0));
    std::sort(instances.begin(), instances.end(),
              [](auto* a, auto* b) { return a->instance_index < b->instance_index; });
    for (const InstanceRecord* instance : instances)
      if (!ended_ && (instance->id_and_mask >> 24 & request_.instance_mask & 0xFF)) try_instance(*instance);
    return hit_;
  }

 private:
  static bool is_valid(const Ray& ray) {
    bool zero = true;
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(ray.origin[k]) || !std::isfinite(ray.direction[k])) return false;
      zero &= ray.direction[k] == 0;
    }
    return !zero && ray.t_min >= 0 && ray.t_min <= ray.t_max;
  }

  bool flag(uint32_t bit) const { return request_.ray_flags & bit; }

  Vector transformed(const InstanceRecord& instance, const float (&v)[3], double w) const {
    const auto& m = instance.world_to_object;
    const auto row = [&](int r) { return m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2] + w * m[r][3]; };
    return {row(0), row(1), row(2)};
  }

  void try_instance(const InstanceRecord& instance) {
    const std::byte* const block = addresses_.host(instance.bottom_level_address);
    const bool triangles = at<StructureHeader>(block, 0).kind == StructureKind::triangles;
    if (flag(triangles ? ray_flag::skip_triangles : ray_flag::skip_procedural_primitives)) return;
    const Vector origin = transformed(instance, request_.ray.origin, 1);
    const Vector direction = transformed(instance, request_.ray.direction, 0);
    for (const Primitive& primitive : primitives_of(block)) {
      if (ended_) return;
      if (triangles)
        try_triangle(instance, primitive, origin, direction);
      else
        try_procedural(instance, primitive);
    }
  }

  /// Table OP-01..06: opaque, or any-hit decides; nothing when culled.
  std::optional<bool> opacity(const InstanceRecord& instance, const Primitive& primitive) const {
    const uint32_t instance_flags = instance.contribution_and_flags >> 24;
    bool opaque = primitive.flags & geometry_flag::opaque;
    if (instance_flags & instance_flag::force_opaque) opaque = true;
    if (instance_flags & instance_flag::force_non_opaque) opaque = false;
    if (flag(ray_flag::force_opaque)) opaque = true;
    if (flag(ray_flag::force_non_opaque)) opaque = false;
    if (flag(opaque ? ray_flag::cull_opaque : ray_flag::cull_non_opaque)) return std::nullopt;
    return opaque;
  }

  bool culled(const InstanceRecord& instance, bool front) const {
    if (instance.contribution_and_flags >> 24 & instance_flag::triangle_cull_disable) return false;
    return flag(front ? ray_flag::cull_front_facing_triangles : ray_flag::cull_back_facing_triangles);
  }

  void try_triangle(const InstanceRecord& instance, const Primitive& primitive, const Vector& origin,
                    const Vector& direction) {
    const std::optional<Found> found = intersect(origin, direction, primitive);
    const std::optional<bool> opaque = opacity(instance, primitive);
    if (!found || !opaque) return;
    const auto t = static_cast<float>(found->t);
    if (!(request_.ray.t_min < t && t < hit_.t)) return;
    const bool swapped = instance.contribution_and_flags >> 24 & instance_flag::triangle_front_counterclockwise;
    const bool front = found->front != swapped;
    if (culled(instance, front)) return;
    Hit hit{t,
            static_cast<float>(found->u),
            static_cast<float>(found->v),
            instance.instance_index,
            primitive.geometry,
            primitive.primitive,
            front ? hit_kind_triangle_front_face : hit_kind_triangle_back_face,
            HitType::triangle};
    if (*opaque || !request_.candidate) return commit(hit, false);
    const Verdict verdict = ask(hit, instance, false);
    if (verdict.commit) commit(hit, verdict.end_search);
    ended_ |= verdict.end_search;
  }

  void try_procedural(const InstanceRecord& instance, const Primitive& primitive) {
    const std::optional<bool> opaque = opacity(instance, primitive);
    if (!request_.candidate || !opaque) return;
    Hit hit{0, 0, 0, instance.instance_index, primitive.geometry, primitive.primitive, 0, HitType::procedural};
    const Verdict verdict = ask(hit, instance, *opaque);
    ended_ |= verdict.end_search;
    if (!verdict.commit) return;
    hit.t = verdict.t;
    hit.hit_kind = verdict.hit_kind;
    commit(hit, verdict.end_search);
  }

  Verdict ask(const Hit& hit, const InstanceRecord& instance, bool opaque) const {
    return request_.candidate(
        request_.user, {hit.type, hit.instance_index, hit.geometry_index, hit.primitive_index, hit.t, hit.u, hit.v,
                        hit.hit_kind, opaque, hit_.t, true, reinterpret_cast<const std::byte*>(&instance)});
  }

  void commit(const Hit& hit, bool end) {
    hit_ = hit;
    ended_ = ended_ || end || flag(ray_flag::accept_first_hit_and_end_search);
  }

  AddressSpace addresses_;
  const TraceRequest& request_;
  Hit hit_;
  bool ended_ = false;
};

class ReferenceWarpTracer final : public WarpTracer {
 public:
  explicit ReferenceWarpTracer(AddressSpace addresses) : addresses_(addresses) {}
  void trace(std::span<TraceCall> calls) override {
    for (TraceCall& call : calls) call.hit = Search(addresses_, call.request).run();
  }

 private:
  AddressSpace addresses_;
};

}  // namespace

std::unique_ptr<WarpTracer> ReferenceTracer::begin_warp(uint64_t) {
  return std::make_unique<ReferenceWarpTracer>(addresses_);
}

}  // namespace rayloom::test
