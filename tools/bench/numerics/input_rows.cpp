// B5, B6: input of random bits, and the ends of what indices can say.

#include <rayloom/base/error.h>
#include <rayloom/tests/accel/structures.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

namespace rayloom::bench::numerics {
namespace {

enum Counter : size_t { wrong, built, refused, traced };

float any_float(Random& random) { return std::bit_cast<float>(static_cast<uint32_t>(random.bits())); }

accel::Builder any_builder(Random& random) {
  const auto builders = accel::all_builders();
  return builders[random.below(static_cast<uint32_t>(builders.size()))];
}

Ray any_ray(Random& random) {
  Ray ray;
  for (float& x : ray.origin) x = any_float(random);
  for (float& x : ray.direction) x = any_float(random);
  ray.t_min = random.chance(2) ? 0 : any_float(random);
  ray.t_max = random.chance(2) ? INFINITY : any_float(random);
  return ray;
}

Mesh any_bits_mesh(Random& random) {
  Mesh mesh;
  const uint32_t count = 1 + random.below(60);
  for (uint32_t i = 0; i < count; ++i) mesh.add({any_float(random), any_float(random), any_float(random)});
  const bool bad = random.chance(8);
  const auto index = [&] {
    return bad && random.chance(32) ? static_cast<uint32_t>(random.bits()) : random.below(count);
  };
  for (uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({index(), index(), index()});
  return mesh;
}

accel::test::Block build_with(const accel::TriangleGeometry& geometry, const accel::BuildSettings& settings) {
  const std::span<const accel::TriangleGeometry> span(&geometry, 1);
  accel::test::Block block(accel::bottom_level_sizes(span, settings).result_bytes);
  block.used = accel::build_bottom_level(span, settings, block.span());
  return block;
}

void trace_garbage(const accel::test::Block& block, Random& random, Tally& tally) {
  for (int i = 0; i < 8; ++i) {
    const Ray ray = any_ray(random);
    const auto flags = static_cast<uint32_t>(random.bits());
    const accel::Hit hit = accel::trace({}, accel::test::request_for(block, ray, flags));
    tally.add(wrong,
              hit && !(hit.t > ray.t_min && hit.t < ray.t_max && hit.u >= 0 && hit.v >= 0 && hit.u + hit.v <= 1));
    ++tally.count[traced];
  }
}

void build_garbage(Random& random, Tally& tally) {
  const Mesh mesh = any_bits_mesh(random);
  Transform3x4 transform;
  for (float& x : transform) x = any_float(random);
  accel::TriangleGeometry geometry = mesh.geometry(random.below(4));
  if (random.chance(2)) geometry.transform = transform.data();
  try {
    const auto block = build_with(geometry, {random.below(32), any_builder(random)});
    ++tally.count[built];
    trace_garbage(block, random, tally);
    std::vector<accel::InstanceDesc> descs(1 + random.below(6), accel::test::instance_of(block));
    for (auto& desc : descs)
      for (auto& row : desc.transform)
        for (float& x : row)
          if (!random.chance(3)) x = any_float(random);
    trace_garbage(accel::test::build_instances(descs, random.below(32)), random, tally);
  } catch (const InputError&) {
    ++tally.count[refused];
  }
}

/// Boxes of any bits, whose intersections are reported at a t of any bits.
void build_garbage_boxes(Random& random, Tally& tally) {
  std::vector<std::array<float, 6>> boxes(1 + random.below(40));
  for (auto& box : boxes)
    for (float& x : box) x = any_float(random);
  const accel::AabbGeometry geometry{reinterpret_cast<const std::byte*>(boxes.data()), sizeof(boxes[0]), boxes.size(),
                                     random.below(4)};
  const auto block = accel::test::build_geometries(std::vector{geometry}, {random.below(32), any_builder(random)});
  ++tally.count[built];
  for (int i = 0; i < 8; ++i) {
    const Ray ray = any_ray(random);
    accel::TraceRequest request = accel::test::request_for(block, ray, static_cast<uint32_t>(random.bits()));
    float report = any_float(random);
    request.user = &report;
    request.candidate = [](void* user, const accel::Candidate&) noexcept {
      return accel::Verdict{true, false, *static_cast<const float*>(user), 0};
    };
    const accel::Hit hit = accel::trace({}, request);
    tally.add(wrong, hit && !(hit.t == report && hit.t >= ray.t_min && hit.t <= ray.t_max));
    ++tally.count[traced];
  }
}

/// Whether building throws InputError.
bool is_refused(const accel::TriangleGeometry& geometry) {
  try {
    build_with(geometry, accel::build_flag::none);
    return false;
  } catch (const InputError&) {
    return true;
  }
}

/// The number of triangles that a build of `geometry` holds.
uint64_t active(const accel::TriangleGeometry& geometry) {
  return accel::structure_info(build_with(geometry, accel::build_flag::none).data()).active_primitives;
}

accel::TriangleGeometry indexed(const Mesh& mesh, const void* indices, accel::IndexFormat format, uint32_t triangles) {
  accel::TriangleGeometry geometry = mesh.geometry();
  geometry.indices = static_cast<const std::byte*>(indices);
  geometry.index_format = format;
  geometry.triangle_count = triangles;
  return geometry;
}

}  // namespace

void run_garbage(RowRun& run) {
  Tally tally = run.sample(run.slow(25000), 32, build_garbage);
  tally.merge(run.sample(run.slow(25000), 32, build_garbage_boxes));
  run.none("hits outside their interval or their triangle", tally.count[wrong], tally.count[traced]);
  run.report("built", static_cast<double>(tally.count[built]), "structures");
  run.report("refused with a reason", static_cast<double>(tally.count[refused]), "structures");
}

void run_index_limits(RowRun& run) {
  using accel::IndexFormat;
  const Mesh mesh = accel::test::icosphere(0);
  uint64_t broken = 0, rules = 0;
  const auto rule = [&](bool holds, const char* what) {
    ++rules;
    if (holds) return;
    ++broken;
    run.note(std::string("broken: ") + what);
  };
  const uint32_t last = 11, beyond[] = {0, 1, 12}, wild[] = {0, 1, 0xFFFFFFFFu}, fine[] = {0, 1, last};
  const uint16_t small[] = {0, 1, 11}, small_wild[] = {0, 1, 0xFFFF};
  rule(is_refused(indexed(mesh, beyond, IndexFormat::uint32, 1)), "the first index out of range is refused");
  rule(is_refused(indexed(mesh, wild, IndexFormat::uint32, 1)), "index 2^32 - 1 is refused");
  rule(is_refused(indexed(mesh, small_wild, IndexFormat::uint16, 1)), "index 65535 of 12 vertices is refused");
  rule(active(indexed(mesh, fine, IndexFormat::uint32, 1)) == 1, "the last vertex may be used");
  rule(active(indexed(mesh, small, IndexFormat::uint16, 1)) == 1, "16-bit indices work");
  rule(active(indexed(mesh, fine, IndexFormat::uint32, 0)) == 0, "no triangles make an empty structure");
  rule(active(indexed(mesh, nullptr, IndexFormat::none, 4)) == 4, "no indices: vertices in order");
  rule(is_refused(indexed(mesh, nullptr, IndexFormat::none, 5)), "more triangles than vertices are refused");
  accel::TriangleGeometry many = mesh.geometry();
  many.triangle_count = (1u << 29) + 1;
  const std::span<const accel::TriangleGeometry> span(&many, 1);
  bool limited = false;
  try {
    accel::bottom_level_sizes(span, accel::build_flag::none);
  } catch (const InputError&) {
    limited = true;
  }
  rule(limited, "more than 2^29 primitives are refused");
  run.none("rules broken", broken, rules, "rules");
}

}  // namespace rayloom::bench::numerics
