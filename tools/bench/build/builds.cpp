#include <rayloom/tools/bench/build/builds.h>

#include <rayloom/base/parallel.h>
#include <rayloom/base/progress.h>
#include <rayloom/tools/bench/ray_sets.h>
#include <rayloom/tools/bench/traced_rays.h>
#include <rayloom/tools/interrupt.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

/// A builder and what it built last.
struct Entry {
  BuildRow row;
  std::optional<accel::Builder> builder;  ///< none: Embree
  uint32_t build_flags = 0;
  EmbreeQuality quality = EmbreeQuality::high;
  std::unique_ptr<OurStructure> structure;
  std::unique_ptr<Peer> peer;
};

/// Who builds the parts of lazy structures.
constexpr accel::Builder lazy_parts = accel::Builder::lbvh;

/// Side of the picture whose rays lazy structures are given, unless the user wants a larger one.
constexpr uint32_t lazy_size = 1024;

std::vector<Entry> make_entries(const BenchScene& scene, const BuildOptions& options) {
  std::vector<Entry> entries;
  const auto add = [&](const std::string& name, bool ours) -> Entry& {
    Entry& entry = entries.emplace_back();
    entry.row.scene = scene.name, entry.row.builder = name, entry.row.ours = ours;
    entry.row.triangles = scene.stored_triangles();
    for (const unsigned threads : options.threads) {
      entry.row.builds.push_back({threads, {name, {}, static_cast<double>(entry.row.triangles)}});
    }
    return entry;
  };
  for (const accel::Builder builder : accel::all_builders()) add(accel::builder_name(builder), true).builder = builder;
  Entry& lazy = add(lazy_builder, true);
  lazy.builder = lazy_parts;
  lazy.build_flags = accel::build_flag::lazy;
  if (!options.against_embree) return entries;
  for (const EmbreeQuality quality : {EmbreeQuality::low, EmbreeQuality::medium, EmbreeQuality::high}) {
    add("Embree " + describe({quality}), false).quality = quality;
  }
  return entries;
}

/// The old structure goes first: memory for two is not needed. `most_threads`: of any build while its result lives.
WorkTime rebuild(Entry& entry, const BenchScene& scene, unsigned threads, unsigned most_threads) {
  const ThreadLimit limit(threads);
  if (entry.builder) {
    entry.structure.reset();
    entry.structure = std::make_unique<OurStructure>(scene, accel::BuildSettings(entry.build_flags, *entry.builder));
    return entry.structure->build_time();
  }
  entry.peer.reset();
  EmbreeOptions options{entry.quality};
  options.threads = most_threads;  // `limit` holds for Embree, too, while a device's holds for us as long as it lives
  entry.peer = make_embree(scene.peer(), options);
  return entry.peer->build_time();
}

/// One round more than counted: the first is the warm-up.
void measure_builds(std::vector<Entry>& entries, const BenchScene& scene, const BuildOptions& options) {
  const uint64_t rounds = options.repetitions + 1;
  std::optional<Progress> progress;
  if (options.progress) {
    progress.emplace(scene.name + " builds", rounds * entries.size() * options.threads.size(), "builds");
  }
  const unsigned most_threads = *std::max_element(options.threads.begin(), options.threads.end());
  for (uint64_t round = 0; round < rounds; ++round) {
    for (size_t t = 0; t < options.threads.size(); ++t) {
      for (size_t k = 0; k < entries.size(); ++k) {
        tools::throw_if_interrupted();
        Entry& entry = entries[round % 2 ? entries.size() - 1 - k : k];
        const unsigned threads = options.threads[t];
        const WorkTime time = rebuild(entry, scene, threads, most_threads);
        const Clock clock = threads == 1 ? Clock::thread_cpu : Clock::wall;
        if (round > 0) entry.row.builds[t].second.seconds.push_back(time.seconds(clock));
        if (progress) progress->advance();
      }
    }
  }
}

void describe_tree(Entry& entry) {
  if (!entry.structure) {
    entry.row.bytes = entry.peer->bytes();
    return;
  }
  const accel::StructureInfo& info = entry.structure->largest();
  entry.row.bytes = entry.structure->bytes();
  if (info.lazy) return;
  const double children = static_cast<double>(info.nodes + info.leaves) - 1;
  entry.row.shape = TreeShape{info.sah_cost, info.depth, info.nodes ? children / static_cast<double>(info.nodes) : 0};
}

bool same_hits(std::span<const accel::Hit> a, std::span<const accel::Hit> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const accel::Hit& x, const accel::Hit& y) {
    return x.type == y.type && x.instance_index == y.instance_index && x.primitive_index == y.primitive_index &&
           x.t == y.t && x.u == y.u && x.v == y.v;
  });
}

void measure_traces(std::vector<Entry>& entries, const BenchScene& scene, const Rays& rays,
                    const BuildOptions& options) {
  std::vector<std::vector<accel::Hit>> hits(entries.size(), std::vector<accel::Hit>(rays.size()));
  std::vector<Measurand> measurands;
  for (size_t i = 0; i < entries.size(); ++i) {
    const TraceRays trace = entries[i].structure
                                ? trace_in_batches(*entries[i].structure, 0, usual_batch)
                                : [&peer = *entries[i].peer](auto r, auto h) { peer.closest_hits(r, h); };
    measurands.push_back(
        {entries[i].row.builder, [&, i, trace] { trace(rays, hits[i]); }, static_cast<double>(rays.size())});
  }
  const auto measured = measure_interleaved(measurands, options.repetitions, Clock::thread_cpu,
                                            options.progress ? scene.name + " rays" : "");
  for (size_t i = 0; i < entries.size(); ++i) {
    entries[i].row.trace = measured[i];
    if (entries[i].row.ours && !same_hits(hits[0], hits[i])) {
      throw std::runtime_error(fmt::format("{}: builders {} and {} give different hits", scene.name,
                                           entries[0].row.builder, entries[i].row.builder));
    }
  }
}

/// Every so many-th ray, so that a few come from all over the picture, too.
Rays spread_over(const Rays& rays, size_t count) {
  Rays some;
  for (size_t i = 0; i < count; ++i) some.push_back(rays[i * rays.size() / count]);
  return some;
}

void run_lazily(Entry& entry, const BenchScene& scene, const Rays& rays, LazyRun& run) {
  WorkTime time = rebuild(entry, scene, 1, 1);
  const ThreadLimit limit(1);
  std::vector<accel::Hit> hits(rays.size());
  time.add([&] { trace_in_batches(*entry.structure, 0, usual_batch)(rays, hits); });
  run.seconds.push_back(time.seconds(Clock::thread_cpu));
  const LazyParts parts = entry.structure->lazy_parts();
  entry.row.parts = parts.all;
  run.built_parts = parts.built;
}

/// At each point of the graph for which there are rays. Leaves a structure that has been traced.
void measure_lazy_runs(Entry& entry, const BenchScene& scene, const Rays& rays, const BuildOptions& options) {
  for (const double count : rays_per_build())
    if (count <= static_cast<double>(rays.size())) entry.row.lazy_runs.push_back({count, {}, 0});
  std::optional<Progress> progress;
  const uint64_t rounds = options.repetitions * entry.row.lazy_runs.size();
  if (options.progress) progress.emplace(scene.name + " lazy builds", rounds, "builds");
  for (uint64_t round = 0; round < options.repetitions; ++round) {
    for (LazyRun& run : entry.row.lazy_runs) {
      tools::throw_if_interrupted();
      run_lazily(entry, scene, spread_over(rays, static_cast<size_t>(run.rays)), run);
      if (progress) progress->advance();
    }
  }
}

/// Seconds between two runs, as if rays in between took alike.
double between(const LazyRun& a, const LazyRun& b, double rays) {
  const double from = spread_of(a.seconds).median, to = spread_of(b.seconds).median;
  return from + (to - from) * (rays - a.rays) / (b.rays - a.rays);
}

}  // namespace

std::vector<double> rays_per_build() {
  std::vector<double> rays;
  for (int quarter = 16; quarter <= 36; ++quarter) rays.push_back(std::pow(10.0, quarter / 4.0));
  return rays;
}

const Measured* BuildRow::built_with(unsigned threads) const {
  for (const auto& [count, measured] : builds) {
    if (count == threads) return &measured;
  }
  return nullptr;
}

double BuildRow::effective_rate(double rays) const { return rays / seconds_for(rays); }

double BuildRow::seconds_for(double rays) const {
  const double build = built_with(1)->time().median, rate = trace.rate().median;
  if (lazy_runs.empty()) return build + rays / rate;
  LazyRun before{0, {build}, 0};
  for (const LazyRun& run : lazy_runs) {
    if (rays <= run.rays) return between(before, run, rays);
    before = run;
  }
  const double seconds = spread_of(before.seconds).median, in_parts = seconds - build - before.rays / rate;
  const double left = static_cast<double>(parts - before.built_parts) / static_cast<double>(before.built_parts);
  return seconds + std::max(0.0, in_parts) * left + (rays - before.rays) / rate;
}

std::vector<BuildRow> run_builds(const std::string& name, const BuildOptions& options) {
  const BenchScene scene = load_bench_scene(name, options.scenes_directory);
  std::vector<Entry> entries = make_entries(scene, options);
  measure_builds(entries, scene, options);
  const auto size = static_cast<uint32_t>(options.size);
  for (Entry& entry : entries) {
    if (!(entry.build_flags & accel::build_flag::lazy)) continue;
    const Rays many = make_ray_sets(scene, *entries.front().structure, std::max(size, lazy_size)).bounce;
    measure_lazy_runs(entry, scene, many, options);
  }
  const Rays rays = make_ray_sets(scene, *entries.front().structure, size).bounce;
  measure_traces(entries, scene, rays, options);
  std::vector<BuildRow> rows;
  for (Entry& entry : entries) {
    describe_tree(entry);
    rows.push_back(std::move(entry.row));
  }
  return rows;
}

}  // namespace rayloom::bench
