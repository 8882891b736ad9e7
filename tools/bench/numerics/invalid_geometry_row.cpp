// K18: NaN, infinities and the largest floats in vertices and boxes. What is invalid is never hit, keeps its index, and
// changes nothing for the others.

#include <rayloom/tests/accel/structures.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <set>

namespace rayloom::bench::numerics {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = accel::Box::infinity;

/// Triangles of a sphere in random order, `spoiled` of them with a bad coordinate; `valid` holds only the others.
struct SpoiledMesh {
  Mesh all, valid;
  std::vector<uint32_t> index_in_all;  ///< of each triangle of `valid`
};

SpoiledMesh spoiled_mesh(Random& random) {
  SpoiledMesh out;
  const Mesh sphere = accel::test::icosphere(2);
  for (const auto& [a, b, c] : sphere.triangles) {
    Triangle t{sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]};
    if (random.chance(5)) {
      const float bad[] = {nan, infinity, -infinity};
      t[random.below(3)][random.below(3)] = bad[random.below(3)];
    } else {
      out.index_in_all.push_back(static_cast<uint32_t>(out.all.triangles.size()));
      out.valid.add_triangle(t[0], t[1], t[2]);
    }
    out.all.add_triangle(t[0], t[1], t[2]);
  }
  return out;
}

void compare_with_valid(Random& random, Tally& tally) {
  const SpoiledMesh meshes = spoiled_mesh(random);
  const auto all = accel::test::build_mesh(meshes.all), valid = accel::test::build_mesh(meshes.valid);
  tally.add(2, accel::structure_info(all.data()).primitives != meshes.all.triangles.size());
  for (int i = 0; i < 50; ++i) {
    const Point& to = meshes.valid.vertices[random.below(static_cast<uint32_t>(meshes.valid.vertices.size()))];
    const Ray ray = ray_between(accel::test::random_point(random, 0.5f), to);
    const accel::Hit hit = accel::trace({}, accel::test::request_for(all, ray));
    accel::Hit expected = accel::trace({}, accel::test::request_for(valid, ray));
    if (expected) expected.primitive_index = meshes.index_in_all[expected.primitive_index];
    ++tally.count[1];
    if (!accel::test::same_bits(hit, expected)) tally.fail(0, ray, {});
  }
}

using BoxFloats = std::array<float, 6>;

/// Whether a ray along z through the middle asks about a box. Beside huge boxes it may ask about small ones near by.
enum class Asked { yes, no, either };

struct BadBox {
  BoxFloats box;
  Asked asked;
};

const BadBox bad_boxes[] = {{{-1, -1, -1, 1, 1, 1}, Asked::yes},
                            {{nan, -1, -1, 1, 1, 1}, Asked::no},
                            {{1, 1, 1, -1, -1, -1}, Asked::either},
                            {{-infinity, -infinity, -infinity, infinity, infinity, infinity}, Asked::either},
                            {{-3.4e38f, -3.4e38f, -3.4e38f, 3.4e38f, 3.4e38f, 3.4e38f}, Asked::yes},
                            {{-1, nan, -1, 1, 1, 1}, Asked::no},
                            {{-2, -2, 2, 2, 2, 3}, Asked::yes}};

/// Which boxes a ray along z asks about.
std::set<uint32_t> asked_boxes(const std::vector<BoxFloats>& boxes) {
  const accel::AabbGeometry geometry{reinterpret_cast<const std::byte*>(boxes.data()), sizeof(BoxFloats), boxes.size(),
                                     0};
  const auto block = accel::test::build_geometries(std::vector{geometry});
  std::set<uint32_t> asked;
  auto request = accel::test::request_for(block, {{0.25f, 0.125f, -5}, 0, {0, 0, 1}, infinity});
  request.user = &asked;
  request.candidate = [](void* user, const accel::Candidate& candidate) noexcept {
    static_cast<std::set<uint32_t>*>(user)->insert(candidate.primitive_index);
    return accel::Verdict{};
  };
  accel::trace({}, request);
  return asked;
}

void try_boxes(Random& random, Tally& tally) {
  std::vector<BoxFloats> boxes;
  std::vector<Asked> expected;
  for (uint32_t i = 0; i < 40; ++i) {
    const BadBox& chosen = bad_boxes[random.below(std::size(bad_boxes))];
    boxes.push_back(chosen.box);
    expected.push_back(chosen.asked);
  }
  const auto asked = asked_boxes(boxes);
  for (uint32_t i = 0; i < boxes.size(); ++i) {
    ++tally.count[5];
    if (expected[i] != Asked::either) tally.add(4, asked.contains(i) != (expected[i] == Asked::yes));
  }
}

/// NULL bottom levels and instances whose every triangle is bad.
void try_instances(Random& random, Tally& tally) {
  const Mesh mesh = accel::test::icosphere(0);
  Mesh bad = mesh;
  for (Point& p : bad.vertices) p[random.below(3)] = nan;
  const auto good_block = accel::test::build_mesh(mesh), bad_block = accel::test::build_mesh(bad);
  std::vector<accel::InstanceDesc> descs{accel::test::instance_of(bad_block), accel::test::instance_of(good_block),
                                         accel::test::instance_of(good_block)};
  descs[1].bottom_level_address = 0;
  const auto top = accel::test::build_instances(descs);
  const Ray ray = ray_between({0, 0, 0}, accel::test::random_point(random, 1));
  tally.add(6, accel::trace({}, accel::test::request_for(top, ray)).instance_index != 2);
}

}  // namespace

void run_invalid_geometry(RowRun& run) {
  const Tally meshes = run.sample(run.slow(2000), 4, compare_with_valid);
  run.none("hits changed by invalid triangles beside them", meshes.count[0], meshes.count[1]);
  run.none("primitive counts changed", meshes.count[2], meshes.cases, "structures");
  const Tally boxes = run.sample(run.slow(10000), 16, try_boxes);
  run.none("boxes wrongly asked about or left out", boxes.count[4], boxes.count[5], "boxes");
  const Tally instances = run.sample(run.slow(5000), 16, try_instances);
  run.none("null and empty bottom levels in the way", instances.count[6], instances.cases);
}

}  // namespace rayloom::bench::numerics
