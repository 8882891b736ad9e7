// T5: meshes that move: collapse to a point, grow a millionfold, change places, turn to NaN, and come back.

#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

namespace rayloom::bench::numerics {
namespace {

/// The positions of one frame.
Mesh frame_of(const Mesh& rest, Random& random) {
  Mesh mesh = rest;
  const uint32_t kind = random.below(5);
  for (Point& p : mesh.vertices)
    for (float& x : p) {
      if (kind == 0) x = 0.5f;
      if (kind == 1) x *= 1e6f;
      if (kind == 2) x += random.uniform(-0.1f, 0.1f);
      if (kind == 3 && random.chance(20)) x = std::numeric_limits<float>::quiet_NaN();
    }
  if (kind == 4)
    for (Point& p : mesh.vertices)
      std::swap(p, mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))]);
  return mesh;
}

bool is_finite(const Point& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

void compare_with_brute_force(const accel::test::Block& block, const Mesh& mesh, Random& random, Tally& tally) {
  const auto triangles = accel::test::all_triangles({mesh.geometry()});
  for (int i = 0; i < 5; ++i) {
    const Point& at = mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))];
    if (!is_finite(at)) continue;
    const Ray ray = ray_between(accel::test::random_point(random, 2), at);
    const auto expected = accel::test::closest_of(accel::test::all_hits(triangles, ray), ray);
    const accel::Hit hit = accel::trace({}, accel::test::request_for(block, ray));
    if (!accel::test::same_bits(hit, expected)) tally.fail(0, ray, {});
    ++tally.count[1];
  }
}

/// One structure through a number of frames, updated in place. The first may be a point: all of it degenerate.
void move_mesh(const Mesh& rest, Random& random, Tally& tally) {
  const auto builders = accel::all_builders();
  const accel::BuildSettings settings(accel::build_flag::allow_update,
                                      builders[random.below(static_cast<uint32_t>(builders.size()))]);
  Mesh mesh = random.chance(2) ? rest : accel::test::moved(rest, 0, 0.25f);
  const accel::TriangleGeometry geometry = mesh.geometry();  // its vertices are replaced in place
  const std::span<const accel::TriangleGeometry> span(&geometry, 1);
  accel::test::Block block(accel::bottom_level_sizes(span, settings).result_bytes);
  accel::build_bottom_level(span, settings, block.span());
  for (int frame = 0; frame < 20; ++frame) {
    const Mesh next = frame_of(rest, random);
    std::copy(next.vertices.begin(), next.vertices.end(), mesh.vertices.begin());
    accel::refit_bottom_level(span, settings, block.data(), block.span());
    compare_with_brute_force(block, mesh, random, tally);
    ++tally.count[2];
  }
}

}  // namespace

void run_refit(RowRun& run) {
  const Mesh rest = accel::test::bumpy_sphere(2);
  const Tally tally = run.sample(run.slow(500), 2, [&](Random& random, Tally& t) { move_mesh(rest, random, t); });
  run.none("hits other than brute force after an update", tally.count[0], tally.count[1]);
  run.report("updates", static_cast<double>(tally.count[2]), "updates");
}

}  // namespace rayloom::bench::numerics
