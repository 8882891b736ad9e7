#include <rayloom/base/det_math.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>

namespace rayloom::bench::numerics {
namespace {

constexpr double two_pi = 6.283185307179586;

Point to_point(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// Two triangles between four vertices in a ring.
void add_quad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// How often a ray in a direction of no significance crosses the mesh, by brute force.
uint32_t crossings(const Mesh& mesh, const Point& origin, const Point& direction) {
  const Ray ray{{origin[0], origin[1], origin[2]}, 0, {direction[0], direction[1], direction[2]}, accel::Box::infinity};
  uint32_t hits = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    hits += product_subject().triangle(ray, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}).has_value();
  return hits;
}

/// Whether the point is inside; nothing for a point of the surface, from which the rays disagree.
std::optional<bool> is_inside(const Mesh& mesh, const Point& origin) {
  uint32_t odd = 0;
  for (uint32_t octant = 0; octant < 8; ++octant) {
    const auto sign = [&](uint32_t axis) { return octant >> axis & 1 ? -1.0f : 1.0f; };
    odd += crossings(mesh, origin, {0.5772157f * sign(0), 0.2614972f * sign(1), 0.9159656f * sign(2)}) % 2;
  }
  return odd == 0 ? std::optional(false) : odd == 8 ? std::optional(true) : std::nullopt;
}

ClosedMesh closed(std::string name, Mesh mesh, bool convex, std::initializer_list<Point> origins) {
  ClosedMesh out{std::move(name), std::move(mesh), {}, convex};
  for (const Point& origin : origins) out.look_from(origin);
  return out;
}

}  // namespace

ClosedMesh& ClosedMesh::look_from(const Point& origin) {
  if (const auto inside = is_inside(mesh, origin)) viewpoints.push_back({origin, *inside});
  return *this;
}

Mesh lathe(std::span<const std::array<double, 2>> profile, uint32_t sides) {
  Mesh mesh;
  const auto rings = static_cast<uint32_t>(profile.size()) - 2;
  const uint32_t first_pole = mesh.add(to_point(0, 0, profile.front()[1]));
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t k = 0; k < sides; ++k) {
      const double angle = two_pi * k / sides, radius = profile[i + 1][0];
      mesh.add(to_point(radius * det::cos(angle), radius * det::sin(angle), profile[i + 1][1]));
    }
  const uint32_t last_pole = mesh.add(to_point(0, 0, profile.back()[1]));
  const auto at = [&](uint32_t ring, uint32_t k) { return 1 + ring * sides + k % sides; };
  for (uint32_t k = 0; k < sides; ++k) {
    mesh.triangles.push_back({first_pole, at(0, k), at(0, k + 1)});
    for (uint32_t i = 0; i + 1 < rings; ++i) add_quad(mesh, at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
    mesh.triangles.push_back({last_pole, at(rings - 1, k + 1), at(rings - 1, k)});
  }
  return mesh;
}

Mesh bipyramid(uint32_t sides) {
  const std::array<double, 2> profile[] = {{0, 1}, {1, 0}, {0, -1}};
  return lathe(profile, sides);
}

Mesh sphere_with_poles(uint32_t sides, uint32_t rings) {
  std::vector<std::array<double, 2>> profile;
  for (uint32_t i = 0; i <= rings + 1; ++i) {
    const double angle = 0.5 * two_pi * i / (rings + 1);
    profile.push_back({det::sin(angle), det::cos(angle)});
  }
  return lathe(profile, sides);
}

Mesh klein_bottle(uint32_t rings, uint32_t sides) {
  Mesh mesh;
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t j = 0; j < sides; ++j) {
      const double u = two_pi * i / rings, v = two_pi * j / sides;
      const double cos_half = det::cos(u / 2), sin_half = det::sin(u / 2), sin_v = det::sin(v),
                   sin_2v = det::sin(2 * v);
      const double radius = 2.5 + cos_half * sin_v - sin_half * sin_2v;
      mesh.add(to_point(radius * det::cos(u), radius * det::sin(u), sin_half * sin_v + cos_half * sin_2v));
    }
  // Once around, the figure of eight comes back upside down: v -> -v.
  const auto at = [&](uint32_t i, uint32_t j) {
    const uint32_t side = j % sides;
    return i < rings ? i * sides + side : (sides - side) % sides;
  };
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t j = 0; j < sides; ++j) add_quad(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return mesh;
}

Mesh mixed_scales(uint32_t sides) {
  std::vector<std::array<double, 2>> profile{{0, 0}};
  for (int exponent = -12; exponent <= 6; ++exponent) {
    const double radius = det::pow(10.0, static_cast<double>(exponent));
    profile.push_back({radius, (exponent % 2 ? 0.25 : -0.25) * radius});
  }
  profile.push_back({0, -1e6});
  return lathe(profile, sides);
}

ClosedMesh placed(const ClosedMesh& closed, float scale, float offset) {
  ClosedMesh out{closed.name, accel::test::moved(closed.mesh, scale, offset), {}, closed.convex};
  for (const Viewpoint& view : closed.viewpoints) {
    Point origin = view.origin;
    for (float& x : origin) x = x * scale + offset;
    out.look_from(origin);
  }
  if (offset != 0) out.convex = false;  // rounded vertices
  return out;
}

std::vector<ClosedMesh> closed_meshes(int level) {
  using namespace accel::test;
  const Point outside{3, 0.5f, -2};
  return {closed("icosphere", icosphere(level), true, {{0.1f, -0.2f, 0.3f}, outside}),
          closed("bumpy sphere", bumpy_sphere(level), false, {{0, 0, 0}, outside}),
          closed("cube", cube(level), true, {{0.1f, 0.5f, 0.25f}, outside}),
          closed("torus", torus(40, 24, 0.375f), false, {{1, 0.0625f, 0}, {0, 0, 0}}),
          closed("Klein's bottle", klein_bottle(48, 32), false, {{2.5f, 0.5f, 0.0625f}, {2.75f, 0, 0.25f}, {0, 0, 0}})};
}

std::vector<ClosedMesh> fan_meshes() {
  std::vector<ClosedMesh> meshes;
  for (const uint32_t sides : {3, 4, 5, 8, 16, 33, 64, 128, 255, 512, 1024})
    meshes.push_back(
        closed("fan of " + std::to_string(sides), bipyramid(sides), true, {{0.0625f, -0.03125f, 0.125f}, {0, 0, 3}}));
  meshes.push_back(
      closed("poles of 2000", sphere_with_poles(2000, 5), true, {{0.0625f, -0.03125f, 0.125f}, {0.5f, 0.25f, 3}}));
  return meshes;
}

}  // namespace rayloom::bench::numerics
