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
std::vector<Mesh> crowded_meshes(uint64_t seed) {
  Random random(seed);
  Mesh cloud;
  for (int i = 0; i < 3000; ++i) {
    const Triangle t = accel::test::shape(random, i % 2 ? accel::test::Family::needle : accel::test::Family::inside);
    cloud.add_triangle(t[0], t[1], t[2]);
  }
  return {accel::test::bumpy_sphere(4), accel::test::torus(60, 30, 0.375f), cloud, accel::test::cube(3)};
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

std::vector<accel::TraceRequest> requests_for(const std::byte* structure, uint64_t rays, uint64_t seed) {
  Random random(seed);
  std::vector<accel::TraceRequest> requests(rays);
  for (auto& request : requests) {
    request.ray = ray_between(accel::test::random_point(random, 2), accel::test::random_point(random, 1));
    request.structure = structure;
  }
  return requests;
}

struct Stream {
  std::vector<accel::Hit> hits;
  uint64_t different_in_batch = 0;  ///< between one ray at a time and a batch
};

/// Hits one by one and as batches.
Stream trace_stream(const std::vector<accel::TraceRequest>& requests) {
  Stream stream;
  stream.hits.resize(requests.size());
  std::vector<accel::Hit> batch(requests.size());
  parallel_for(requests.size(), 1024, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) stream.hits[i] = accel::trace({}, requests[i]);
    accel::trace({}, std::span(requests).subspan(begin, end - begin), std::span(batch).subspan(begin, end - begin));
  });
  for (size_t i = 0; i < batch.size(); ++i)
    stream.different_in_batch += !accel::test::same_bits(stream.hits[i], batch[i]);
  return stream;
}

Stream trace_stream(const Block& block, uint64_t rays, uint64_t seed) {
  return trace_stream(requests_for(block.data(), rays, seed));
}

uint64_t differences(const Stream& a, const Stream& b) {
  uint64_t count = 0;
  for (size_t i = 0; i < a.hits.size(); ++i) count += !accel::test::same_bits(a.hits[i], b.hits[i]);
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

/// Hits of shuffled geometries: the same t; the same triangle too, unless several have that t.
void compare_shuffled(const Shuffled& shuffled, const Stream& before, const Stream& after, uint64_t& other_t,
                      uint64_t& other_hit) {
  for (size_t i = 0; i < before.hits.size(); ++i) {
    const accel::Hit &a = before.hits[i], &b = after.hits[i];
    if (std::bit_cast<uint32_t>(a.t) != std::bit_cast<uint32_t>(b.t) || static_cast<bool>(a) != static_cast<bool>(b)) {
      ++other_t;
      continue;
    }
    if (!a) continue;
    const bool same_triangle = a.geometry_index == shuffled.geometry[b.geometry_index] &&
                               a.primitive_index == shuffled.triangle[b.geometry_index][b.primitive_index];
    // Among equal t the smallest new name wins.
    if (same_triangle) other_hit += std::bit_cast<uint32_t>(a.u) != std::bit_cast<uint32_t>(b.u) || a.v != b.v;
  }
}

}  // namespace

void run_threads(RowRun& run) {
  const auto meshes = crowded_meshes(run.seed());
  const uint64_t rays = run.rays(20000);
  uint64_t other_bytes = 0, other_hits = 0, builds = 0;
  for (const accel::Builder builder : accel::all_builders()) {
    std::optional<uint64_t> expected;
    std::optional<Stream> stream;
    for (const unsigned threads : {1, 2, 3, 7, 16, 64}) {
      const ThreadLimit limit(threads);
      const Block block = build(meshes, {accel::build_flag::none, builder});
      const Stream hits = trace_stream(block, rays, run.seed());
      other_bytes += bytes_hash(block) != expected.value_or(bytes_hash(block));
      if (stream) other_hits += differences(*stream, hits);
      if (!expected) expected = bytes_hash(block), stream = hits;
      ++builds;
    }
  }
  run.none("structures with other bytes than one thread's", other_bytes, builds, "builds");
  run.none("hits that differ from one thread's", other_hits, rays * builds);
}

void run_instruction_sets(RowRun& run) {
  const auto meshes = crowded_meshes(run.seed());
  const Block block = build(meshes, accel::build_flag::none);
  const uint64_t rays = run.rays(100000);
  const auto requests = requests_for(block.data(), rays, run.seed());
  std::optional<Stream> expected;
  uint64_t different = 0, batch = 0, sets = 0;
  accel::test::for_each_isa([&](accel::Isa) {
    const Stream stream = trace_stream(requests);
    if (expected) different += differences(*expected, stream);
    if (!expected) expected = stream;
    batch += stream.different_in_batch;
    ++sets;
  });
  run.none("hits that differ between instruction sets", different, rays * (sets - 1));
  run.none("hits that differ between one ray and a batch", batch, rays * sets);
  run.report("instruction sets", static_cast<double>(sets), "");
}

void run_orders(RowRun& run) {
  const auto meshes = crowded_meshes(run.seed());
  const uint64_t rays = run.rays(5000), shuffles = std::min<uint64_t>(100, run.slow(10));
  const Stream before = trace_stream(build(meshes, accel::build_flag::none), rays, run.seed());
  Random random(run.seed());
  uint64_t other_t = 0, other_hit = 0;
  for (uint64_t i = 0; i < shuffles; ++i) {
    const Shuffled other = shuffled(meshes, random);
    compare_shuffled(other, before, trace_stream(build(other.meshes, accel::build_flag::none), rays, run.seed()),
                     other_t, other_hit);
  }
  run.none("other t than in the first order", other_t, rays * shuffles);
  run.none("other u or v of the same triangle", other_hit, rays * shuffles);
}

void run_build_modes(RowRun& run) {
  const auto meshes = crowded_meshes(run.seed());
  const uint64_t rays = run.rays(5000);
  const Stream expected = trace_stream(build(meshes, accel::build_flag::none), rays, run.seed());
  uint64_t different = 0, copied = 0, modes = 0;
  for (const accel::Builder builder : accel::all_builders())
    for (uint32_t flags = 0; flags < 32; ++flags) {
      if ((flags & accel::build_flag::prefer_fast_trace) && (flags & accel::build_flag::prefer_fast_build)) continue;
      const Block block = build(meshes, {flags, builder});
      different += differences(expected, trace_stream(block, rays, run.seed()));
      Block elsewhere(block.size());  // as bytes written and read again
      std::memcpy(elsewhere.data(), block.data(), block.used);
      copied += differences(expected, trace_stream(elsewhere, rays, run.seed()));
      ++modes;
    }
  run.none("hits that differ from the default build's", different, rays * modes);
  run.none("hits that differ after a copy of the bytes", copied, rays * modes);
}

}  // namespace rayloom::bench::numerics
