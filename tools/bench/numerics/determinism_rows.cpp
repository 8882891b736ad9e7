// B7 to B10: the same bits for any number of threads, instruction set, order of the input and way of building.

#include <rayloom/tests/accel/structures.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <numeric>

namespace rayloom::bench::numerics {
namespace {

using accel::test::Block;

/// Geometries that share space, so that order matters: a bumpy sphere, a torus and a cloud of slivers.
std::vector<Mesh> crowded_meshes(int level, uint64_t seed) {
  Random random(seed);
  Mesh cloud;
  for (int i = 0; i < 200 << level; ++i) {
    const Triangle t = accel::test::shape(random, i % 2 ? accel::test::Family::needle : accel::test::Family::inside);
    cloud.add_triangle(t[0], t[1], t[2]);
  }
  return {accel::test::bumpy_sphere(level), accel::test::torus(4u << level, 2u << level, 0.375f), cloud,
          accel::test::cube(level - 1)};
}

Block build(const std::vector<Mesh>& meshes, const accel::BuildSettings& settings) {
  std::vector<accel::TriangleGeometry> geometries;
  for (const Mesh& mesh : meshes) geometries.push_back(mesh.geometry());
  const std::span<const accel::TriangleGeometry> span(geometries);
  Block block(accel::bottom_level_sizes(span, settings).result_bytes);
  block.used = accel::build_bottom_level(span, settings, block.span());
  return block;
}

uint64_t bytes_hash(const Block& block) {
  uint64_t hash = block.used;
  for (uint64_t i = 0; i < block.used; i += 4) {
    uint32_t word;
    std::memcpy(&word, block.data() + i, 4);
    hash = mix64(hash ^ word);
  }
  return hash;
}

constexpr uint64_t block_rays = 512;

/// The rays of one block, the same for every structure.
std::vector<Ray> block_of_rays(uint64_t seed, uint64_t block) {
  Random random(Hash64(seed).add(block).value());
  std::vector<Ray> rays(block_rays);
  for (Ray& ray : rays) ray = ray_between(accel::test::random_point(random, 2), accel::test::random_point(random, 1));
  return rays;
}

std::vector<accel::Hit> trace_one_by_one(const std::byte* structure, const std::vector<Ray>& rays) {
  std::vector<accel::Hit> hits;
  accel::TraceRequest request;
  request.structure = structure;
  for (const Ray& ray : rays) {
    request.ray = ray;
    hits.push_back(accel::trace({}, request));
  }
  return hits;
}

std::vector<accel::Hit> trace_batch(const std::byte* structure, const std::vector<Ray>& rays) {
  std::vector<accel::Hit> hits(rays.size());
  accel::TraceRequest shared;
  shared.structure = structure;
  accel::trace({}, shared, rays, hits);
  return hits;
}

uint64_t hash_of(const std::vector<accel::Hit>& hits) {
  Hash64 hash;
  for (const accel::Hit& hit : hits)
    hash.add(hit.t).add(hit.u).add(hit.v).add(hit.geometry_index).add(hit.primitive_index).add(hit.hit_kind);
  return hash.value();
}

/// A hash of each block's hits: what many rays hit, in little memory.
struct Digests {
  std::vector<uint64_t> one_by_one;
  uint64_t other_in_batch = 0;  ///< blocks

  uint64_t rays() const { return one_by_one.size() * block_rays; }
};

Digests trace_blocks(RowRun& run, const std::byte* structure, Cases rays) {
  const Cases blocks = rays / block_rays;
  Digests digests{std::vector<uint64_t>(blocks.count)};
  digests.other_in_batch = run.sample(blocks, 4,
                                      [&](Random&, Tally& t) {
                                        const auto block = block_of_rays(run.seed(), t.index);
                                        uint64_t& digest = digests.one_by_one[t.index];
                                        digest = hash_of(trace_one_by_one(structure, block));
                                        t.add(0, digest != hash_of(trace_batch(structure, block)));
                                      })
                               .count[0];
  return digests;
}

/// Blocks with other hits.
uint64_t differences(const Digests& a, const Digests& b) {
  uint64_t count = 0;
  for (size_t i = 0; i < a.one_by_one.size(); ++i) count += a.one_by_one[i] != b.one_by_one[i];
  return count;
}

/// Geometries in another order.
struct Shuffled {
  std::vector<Mesh> meshes;
  std::vector<uint32_t> geometry;               ///< of each new geometry, the old one
  std::vector<std::vector<uint32_t>> triangle;  ///< of each new triangle, the old one
};

void shuffle(std::vector<uint32_t>& order, Random& random) {
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<uint32_t>(i))]);
}

Shuffled shuffled(const std::vector<Mesh>& meshes, Random& random) {
  Shuffled out;
  out.geometry.resize(meshes.size());
  std::iota(out.geometry.begin(), out.geometry.end(), 0u);
  shuffle(out.geometry, random);
  for (const uint32_t old : out.geometry) {
    Mesh mesh = meshes[old];
    std::vector<uint32_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    shuffle(order, random);
    for (size_t i = 0; i < order.size(); ++i) mesh.triangles[i] = meshes[old].triangles[order[i]];
    out.meshes.push_back(std::move(mesh));
    out.triangle.push_back(std::move(order));
  }
  return out;
}

enum Counter : size_t { other_t, other_weights };

/// Hits of shuffled geometries: the same t; the same u and v, unless several triangles have that t.
void compare_shuffled(const Shuffled& shuffled, const std::vector<accel::Hit>& before,
                      const std::vector<accel::Hit>& after, Tally& tally) {
  const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
  for (size_t i = 0; i < before.size(); ++i) {
    const accel::Hit &a = before[i], &b = after[i];
    const bool same_t = bits(a.t) == bits(b.t) && static_cast<bool>(a) == static_cast<bool>(b);
    tally.add(other_t, !same_t);
    if (!same_t || !a) continue;
    const bool same_triangle = a.geometry_index == shuffled.geometry[b.geometry_index] &&
                               a.primitive_index == shuffled.triangle[b.geometry_index][b.primitive_index];
    // Among equal t the smallest new name wins.
    tally.add(other_weights, same_triangle && (bits(a.u) != bits(b.u) || bits(a.v) != bits(b.v)));
  }
}

/// Updates a structure with the geometry it was built from.
void refit(const std::vector<Mesh>& meshes, const accel::BuildSettings& settings, const Block& block) {
  std::vector<accel::TriangleGeometry> geometries;
  for (const Mesh& mesh : meshes) geometries.push_back(mesh.geometry());
  accel::refit_bottom_level(std::span<const accel::TriangleGeometry>(geometries), settings, block.data(), block.span());
}

/// All combinations that DXR allows.
std::vector<accel::BuildSettings> all_settings() {
  using namespace accel::build_flag;
  std::vector<accel::BuildSettings> all;
  for (const accel::Builder builder : accel::all_builders())
    for (uint32_t flags = 0; flags < 32; ++flags)
      if (!(flags & prefer_fast_trace) || !(flags & prefer_fast_build)) all.emplace_back(flags, builder);
  return all;
}

}  // namespace

void run_threads(RowRun& run) {
  const auto meshes = crowded_meshes(4, run.seed());
  uint64_t other_bytes = 0, other_hits = 0, rays = 0, builds = 0;
  for (const accel::Builder builder : accel::all_builders()) {
    std::optional<uint64_t> expected;
    std::optional<Digests> hits;
    for (const unsigned threads : {1, 2, 3, 7, 16, 64}) {
      const ThreadLimit limit(threads);
      const Block block = build(meshes, {accel::build_flag::none, builder});
      const uint64_t bytes = bytes_hash(block);
      const Digests here = trace_blocks(run, block.data(), run.rays(20000));
      other_bytes += bytes != expected.value_or(bytes);
      if (hits) other_hits += differences(*hits, here);
      if (!hits) expected = bytes, hits = here;
      rays += here.rays();
      ++builds;
    }
  }
  run.none("structures with other bytes than one thread's", other_bytes, builds, "builds");
  run.none("blocks of hits that differ from one thread's", other_hits, rays);
}

void run_instruction_sets(RowRun& run) {
  const Block block = build(crowded_meshes(4, run.seed()), accel::build_flag::none);
  std::optional<Digests> expected;
  uint64_t different = 0, batch = 0, rays = 0, sets = 0;
  accel::test::for_each_isa([&](accel::Isa) {
    const Digests hits = trace_blocks(run, block.data(), run.rays(100000));
    if (expected) different += differences(*expected, hits);
    if (!expected) expected = hits;
    batch += hits.other_in_batch;
    rays += hits.rays();
    ++sets;
  });
  run.none("blocks of hits that differ between instruction sets", different, rays);
  run.none("blocks of hits that differ between one ray and a batch", batch, rays);
  run.report("instruction sets", static_cast<double>(sets), "");
}

void run_orders(RowRun& run) {
  const auto meshes = crowded_meshes(3, run.seed());
  const Block before = build(meshes, accel::build_flag::none);
  Random random(run.seed());
  Tally total;
  uint64_t rays = 0;
  const uint64_t shuffles = std::min<uint64_t>(100, run.slow(20).count);
  for (uint64_t i = 0; i < shuffles; ++i) {
    const Shuffled other = shuffled(meshes, random);
    const Block after = build(other.meshes, accel::build_flag::none);
    const Cases blocks = run.rays(5000) / block_rays;
    total.merge(run.sample(blocks, 4, [&](Random&, Tally& t) {
      const auto block = block_of_rays(run.seed(), t.index);
      compare_shuffled(other, trace_batch(before.data(), block), trace_batch(after.data(), block), t);
    }));
    rays += blocks.count * block_rays;
  }
  run.none("other t than in the first order", total.count[other_t], rays);
  run.none("other u or v of the same triangle", total.count[other_weights], rays);
}

void run_build_modes(RowRun& run) {
  const auto meshes = crowded_meshes(3, run.seed());
  const Cases rays = run.rays(5000);
  const Digests expected = trace_blocks(run, build(meshes, accel::build_flag::none).data(), rays);
  uint64_t different = 0, copied = 0, updated = 0, modes = 0, updates = 0;
  for (const accel::BuildSettings& settings : all_settings()) {
    const Block block = build(meshes, settings);
    different += differences(expected, trace_blocks(run, block.data(), rays));
    Block elsewhere(block.size());  // as compaction does, or bytes written and read again
    std::memcpy(elsewhere.data(), block.data(), block.used);
    copied += differences(expected, trace_blocks(run, elsewhere.data(), rays));
    ++modes;
    if (!(settings.flags & accel::build_flag::allow_update)) continue;
    refit(meshes, settings, block);
    updated += differences(expected, trace_blocks(run, block.data(), rays));
    ++updates;
  }
  run.none("blocks of hits that differ from the default build's", different, expected.rays() * modes);
  run.none("blocks of hits that differ after a copy of the bytes", copied, expected.rays() * modes);
  run.none("blocks of hits that differ after an update", updated, expected.rays() * updates);
}

}  // namespace rayloom::bench::numerics
