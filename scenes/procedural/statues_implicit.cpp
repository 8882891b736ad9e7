// Sculptures that are where a function of space is negative.

#include "distance.h"
#include "gradient_noise.h"
#include "isosurface.h"
#include "statues.h"

#include <rayloom/base/det_math.h>

#include <algorithm>
#include <vector>

namespace rayloom::scenes::statues {
namespace {

constexpr float pi = 3.14159265f;

/// Slow waves in all directions, within [-1, 1].
float wobble(glm::vec3 p, uint32_t seed) {
  float sum = 0;
  for (uint32_t i = 0; i < 4; ++i) {
    const auto random = [&](uint32_t what) { return 2 * unit_float(hash64(seed, i, what, 4u)) - 1; };
    sum += det::sin(glm::dot(p, glm::vec3(random(0), random(1), random(2))) * 3.0f + pi * random(3));
  }
  return 0.25f * sum;
}

/// A draped figure of about 1.8 m. Weight on one leg, arms by `seed`.
class Figure {
 public:
  explicit Figure(uint32_t seed) : seed_(seed) {
    const auto random = [&](uint32_t what) { return unit_float(hash64(seed, what, 5u)); };
    lean_ = 0.05f * (2 * random(0) - 1);
    turn_ = 0.06f * (2 * random(1) - 1);
    const glm::vec3 hip(lean_, 0.98f, 0), chest(0.3f * lean_, 1.32f, -0.01f);
    head_ = chest + glm::vec3(turn_, 0.40f, 0.03f);
    body_ = {{hip, chest, 0.145f, 0.155f}, {chest, chest + glm::vec3(0, 0.24f, 0), 0.06f, 0.05f}};
    for (const float side : {-1.0f, 1.0f}) add_arm(chest, side, random(side < 0 ? 2 : 3), random(side < 0 ? 4 : 5));
    robe_ = {{1.2f * lean_, 0.10f, 0.03f}, hip, 0.27f, 0.15f};
  }

  float distance(glm::vec3 p) const {
    float d = robe_.distance(p);
    for (const Limb& limb : body_) d = blend(d, limb.distance(p), 0.07f);
    for (const Limb& limb : arms_) d = blend(d, limb.distance(p), 0.035f);
    d += folds(p);
    d = blend(d, ellipsoid(p - head_, {0.085f, 0.115f, 0.10f}), 0.03f);
    d = blend(d, ellipsoid(p - head_ - glm::vec3(0, 0.045f, -0.05f), {0.075f, 0.075f, 0.075f}), 0.02f);  // hair
    d = blend(d, ellipsoid(p - head_ - glm::vec3(0, -0.01f, 0.098f), {0.014f, 0.03f, 0.018f}), 0.025f);  // nose
    const float plinth = std::max(std::fabs(p.y - 0.03f) - 0.03f, length({p.x, 0, p.z}) - 0.36f);
    return 0.7f * std::max(blend(d, plinth, 0.02f), -p.y);
  }

 private:
  void add_arm(glm::vec3 chest, float side, float raise, float bend) {
    const glm::vec3 shoulder = chest + glm::vec3(0.17f * side, 0.10f, 0);
    const float angle = 0.25f + 1.6f * raise * raise;
    const auto [s, c] = det::sincos(angle);
    const glm::vec3 elbow = shoulder + 0.28f * glm::vec3(side * s, -c, 0.12f);
    const auto [sb, cb] = det::sincos(angle + 0.3f + 1.6f * bend);
    const glm::vec3 hand = elbow + 0.25f * glm::vec3(side * sb * (raise > 0.5f ? 0.7f : -0.5f), -cb, 0.45f);
    arms_.push_back({chest + glm::vec3(0.05f * side, 0.13f, 0), shoulder, 0.06f, 0.062f});
    arms_.push_back({shoulder, elbow, 0.056f, 0.043f});
    arms_.push_back({elbow, hand, 0.042f, 0.028f});
    arms_.push_back({hand, hand + glm::vec3(0, -0.03f, 0.06f), 0.032f, 0.018f});
  }

  /// Pleats that widen towards the floor and run out below the shoulders.
  float folds(glm::vec3 p) const {
    const float strength = 0.020f * smooth_step(1.25f, 0.35f, p.y) + 0.005f * smooth_step(1.5f, 1.2f, p.y);
    const float angle = det::atan2(p.z, p.x - lean_);
    const float drift = 1.4f * gradient_noise({1.6f * p.y, 1.5f * p.x}, seed_).value;
    return strength * (det::sin(11 * angle + 3 * drift + 2 * p.y) + 0.45f * det::sin(23 * angle - 4 * drift));
  }

  static float smooth_step(float zero, float one, float x) {
    const float t = std::clamp((x - zero) / (one - zero), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  }

  uint32_t seed_;
  float lean_ = 0, turn_ = 0;
  glm::vec3 head_{0};
  Limb robe_{};
  std::vector<Limb> body_, arms_;
};

Geometry meshed(const Solid& solid, uint64_t triangles) {
  Geometry geometry;
  add_isosurface_of(geometry, solid, triangles);
  return geometry;
}

}  // namespace

Geometry figure(uint64_t triangles, uint32_t seed) {
  const Solid solid{{{-0.75f, -0.02f, -0.45f}, {0.75f, 1.95f, 0.5f}},
                    [body = Figure(seed)](glm::vec3 p) { return body.distance(p); }};
  return meshed(solid, triangles);
}

Geometry pierced(uint64_t triangles, uint32_t seed) {
  const auto random = [seed](uint32_t what) { return 2 * unit_float(hash64(seed, what, 6u)) - 1; };
  const glm::vec3 radii(0.62f + 0.1f * random(0), 1.0f, 0.42f + 0.08f * random(1));
  const Limb holes[2] = {
      {{0.12f * random(2), 0.32f + 0.1f * random(3), -2}, {0.1f * random(4), 0.35f, 2}, 0.24f, 0.17f},
      {{0.2f * random(5), -0.35f, -2}, {0.25f * random(6), -0.3f + 0.1f * random(7), 2}, 0.12f, 0.2f}};
  const Solid solid{{{-1.0f, -1.25f, -0.8f}, {1.0f, 1.25f, 0.8f}}, [=](glm::vec3 p) {
                      float d = ellipsoid(p, radii) + 0.07f * wobble(p, seed);
                      for (const Limb& hole : holes) d = carve(d, hole.distance(p), 0.12f);
                      return 0.7f * std::max(d, -0.93f - p.y);
                    }};
  return meshed(solid, triangles);
}

Geometry lattice(uint64_t triangles, uint32_t seed) {
  const auto random = [seed](uint32_t what) { return unit_float(hash64(seed, what, 7u)); };
  const float frequency = 6 + 4 * random(0), level = 0.5f * random(1) - 0.1f, height = 0.8f + 0.4f * random(2);
  const glm::vec3 radii(0.62f, 0.62f * height + 0.2f, 0.62f);
  const Solid solid{{-radii - 0.05f, radii + 0.05f}, [=](glm::vec3 p) {
                      const auto [sx, cx] = det::sincos(frequency * p.x);
                      const auto [sy, cy] = det::sincos(frequency * p.y);
                      const auto [sz, cz] = det::sincos(frequency * p.z);
                      const float gyroid = sx * cy + sy * cz + sz * cx - level;
                      const float walls = gyroid / (1.75f * frequency);
                      return 0.9f * carve(ellipsoid(p, radii), -walls, 0.1f);
                    }};
  return meshed(solid, triangles);
}

}  // namespace rayloom::scenes::statues
