#pragma once

// Packets of rays with a leaf and a node of eight that lie around them in every way that may go wrong.

#include "integer_oracle.h"
#include "lane_cases.h"
#include "packet_question.h"
#include "structures.h"

#include <algorithm>

namespace rayloom::accel::test {

/// Rays of one origin or of neighbouring ones, and triangles that graze them, lie beside them by an edge or a corner,
/// or behind.
struct PacketCase {
  std::vector<Ray> rays = std::vector<Ray>(most_packet_rays);
  std::vector<Triangle> triangles;
};

/// Of any slope: in a plane of the axes, on a diagonal (where the dominant axis is a tie or nearly so), anywhere.
inline Point main_direction(Random& random) {
  Point d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const uint32_t style = random.below(4), axis = random.below(3);
  if (style == 0) d[axis] = random.chance(2) ? 0.0f : random.scaled(-40, -10);
  if (style == 1) d[axis] = random.nudged(std::copysign(d[(axis + 1) % 3], d[axis]), 2);
  if (style == 2) d[axis] = d[(axis + 1) % 3] = random.scaled(-30, -1);
  return d;
}

inline void aim(Random& random, float scale, float apart, PacketCase& out) {
  const float length = std::ldexp(1.0f, static_cast<int>(random.below(60)) - 30);
  const float spreads[] = {0, 1e-7f, 1e-4f, 0.01f, 0.05f, 0.12f};
  const float spread = spreads[random.below(6)], distance = random.chance(3) ? 1e3f : 1;
  const Point middle = main_direction(random);
  float origin[3];
  for (float& x : origin) x = random.uniform(-1, 1) * scale * distance;
  for (Ray& ray : out.rays) {
    std::copy_n(origin, 3, ray.origin);
    if (apart > 0)
      for (float& x : ray.origin) x += apart * scale * random.uniform(-1, 1);
    for (int k = 0; k < 3; ++k)
      ray.direction[k] = random.nudged(middle[k] * (1 + spread * random.uniform(-1, 1)), random.below(3)) * length;
    ray.t_min = 0;
    ray.t_max = std::numeric_limits<float>::infinity();
  }
}

/// Around a point of one of the rays.
inline Triangle beside(Random& random, const Ray& ray, float scale) {
  const float far = std::ldexp(scale, static_cast<int>(random.below(16)) - 8) * (random.chance(12) ? -1.0f : 1.0f);
  const float size = std::fabs(far) * std::ldexp(1.0f, static_cast<int>(random.below(28)) - 24);
  float dominant = 0;
  for (const float x : ray.direction) dominant = std::max(dominant, std::fabs(x));
  Point at, along;
  for (int k = 0; k < 3; ++k) along[k] = ray.direction[k] / dominant, at[k] = ray.origin[k] + along[k] * far;
  const auto off = [&](float by) {
    return Point{at[0] + by * random.uniform(-1, 1), at[1] + by * random.uniform(-1, 1),
                 at[2] + by * random.uniform(-1, 1)};
  };
  Triangle t = {off(size), off(size), off(size)};
  const uint32_t kind = random.below(6);
  if (kind == 0) t[random.below(3)] = at;
  if (kind == 1)  // an edge through the point
    for (int k = 0; k < 3; ++k) t[1][k] = at[k] - (t[0][k] - at[k]) * 0.5f;
  if (kind == 2)  // nearly edge on
    for (int k = 0; k < 3; ++k) {
      t[0][k] = at[k] - along[k] * size + 1e-6f * (t[0][k] - at[k]);
      t[1][k] = at[k] + along[k] * size + 1e-6f * (t[1][k] - at[k]);
      t[2][k] = at[k] + 1e-6f * (t[2][k] - at[k]);
    }
  if (kind == 4) {  // a sliver around the point: certainly hit, with hardly any area
    const float thin = std::ldexp(1.0f, -4 - static_cast<int>(random.below(20)));
    const Triangle wide = {off(8 * size), off(8 * size), off(8 * size)};
    for (int k = 0; k < 3; ++k) {
      const float across = thin * (wide[1][k] - at[k]);
      t[0][k] = wide[0][k] - across / 3;
      t[1][k] = at[k] - 0.7f * (wide[0][k] - at[k]) - across / 3;
      t[2][k] = at[k] + 0.1f * (wide[0][k] - at[k]) + across;
    }
  }
  if (kind == 3)  // large and close by
    for (Point& corner : t) corner = off(16 * std::fabs(far));
  return t;
}

/// `apart`: how far origins may be from one another, over the triangles' size; 0: one origin.
inline PacketCase random_packet(Random& random, float apart = 0) {
  PacketCase out;
  const float scale = std::ldexp(1.0f, static_cast<int>(random.below(64)) - 42);
  aim(random, scale, apart, out);
  for (int i = 0; i < 8; ++i) out.triangles.push_back(beside(random, out.rays[random.below(most_packet_rays)], scale));
  return out;
}

inline PacketQuestion question_of(const PacketCase& c, Random& random) {
  PacketQuestion question{c.rays.data(), {}, {}, {}, plain_leaf(8)};
  Box root;
  for (int lane = 0; lane < 8; ++lane) {
    Box box;
    for (int i = 0; i < 3; ++i) {
      const Point& p = c.triangles[lane][i];
      box.extend({p[0], p[1], p[2]});
      for (int k = 0; k < 3; ++k) question.leaf.vertex[k][i][lane] = p[k];
    }
    for (int k = 0; k < 3; ++k)
      question.node.bounds[k][0][lane] = box.min[k], question.node.bounds[k][1][lane] = box.max[k];
    root.extend(box.min, box.max);
  }
  for (int k = 0; k < 3; ++k) {
    const float more = random.chance(2) ? 0 : random.uniform(0, 4) * (root.max[k] - root.min[k]);
    question.header.bounds_min[k] = root.min[k] - more;
    question.header.bounds_max[k] = root.max[k] + more;
  }
  return question;
}

using Hits = std::vector<std::array<std::optional<IntegerHit>, 8>>;  ///< by ray and triangle

inline Hits exact_hits(const PacketCase& c) {
  Hits hits(c.rays.size());
  for (size_t i = 0; i < c.rays.size(); ++i)
    for (int lane = 0; lane < 8; ++lane) hits[i][lane] = integer_hit(c.rays[i], c.triangles[lane]);
  return hits;
}

/// Limits at hits, or a float beside them.
inline void limit(PacketCase& c, const Hits& hits, Random& random, PacketQuestion& question) {
  for (size_t i = 0; i < c.rays.size(); ++i) {
    question.t_far[i] = std::numeric_limits<float>::infinity();
    const auto& hit = hits[i][random.below(8)];
    if (!hit || !(hit->t > 0) || std::isinf(hit->t)) continue;
    const uint32_t kind = random.below(8);
    if (kind < 4) question.t_far[i] = kind == 0 ? std::nextafter(hit->t, 0.0f) : hit->t;
    if (kind == 4) c.rays[i].t_min = hit->t;
    if (kind == 5) c.rays[i].t_min = std::nextafter(hit->t, 0.0f);
  }
}

}  // namespace rayloom::accel::test
