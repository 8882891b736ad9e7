#include <rayloom/tools/bench/build/builds.h>

#include <rayloom/base/parallel.h>
#include <rayloom/base/progress.h>
#include <rayloom/tools/bench/ray_sets.h>
#include <rayloom/tools/bench/traced_rays.h>
#include <rayloom/tools/interrupt.h>

#include <stdexcept>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

/// A builder and what it built last.
struct Entry {
  BuildRow row;
  std::optional<accel::Builder> builder;  ///< none: Embree
  EmbreeQuality quality = EmbreeQuality::high;
  std::unique_ptr<OurStructure> structure;
  std::unique_ptr<Peer> peer;
};

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
  if (!options.against_embree) return entries;
  for (const EmbreeQuality quality : {EmbreeQuality::low, EmbreeQuality::medium, EmbreeQuality::high}) {
    add("Embree " + describe({quality}), false).quality = quality;
  }
  return entries;
}

/// The old structure goes first: memory for two is not needed.
WorkTime rebuild(Entry& entry, const BenchScene& scene, unsigned threads) {
  const ThreadLimit limit(threads);
  if (entry.builder) {
    entry.structure.reset();
    entry.structure = std::make_unique<OurStructure>(scene, accel::BuildSettings(0, *entry.builder));
    return entry.structure->build_time();
  }
  entry.peer.reset();
  EmbreeOptions options{entry.quality};
  options.threads = threads;
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
  for (uint64_t round = 0; round < rounds; ++round) {
    for (size_t t = 0; t < options.threads.size(); ++t) {
      for (size_t k = 0; k < entries.size(); ++k) {
        tools::throw_if_interrupted();
        Entry& entry = entries[round % 2 ? entries.size() - 1 - k : k];
        const unsigned threads = options.threads[t];
        const WorkTime time = rebuild(entry, scene, threads);
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

}  // namespace

const Measured* BuildRow::built_with(unsigned threads) const {
  for (const auto& [count, measured] : builds) {
    if (count == threads) return &measured;
  }
  return nullptr;
}

double BuildRow::effective_rate(double rays) const {
  return rays / (built_with(1)->time().median + rays / trace.rate().median);
}

std::vector<BuildRow> run_builds(const std::string& name, const BuildOptions& options) {
  const BenchScene scene = load_bench_scene(name, options.scenes_directory);
  std::vector<Entry> entries = make_entries(scene, options);
  measure_builds(entries, scene, options);
  const Rays rays = make_ray_sets(scene, *entries.front().structure, static_cast<uint32_t>(options.size)).bounce;
  measure_traces(entries, scene, rays, options);
  std::vector<BuildRow> rows;
  for (Entry& entry : entries) {
    describe_tree(entry);
    rows.push_back(std::move(entry.row));
  }
  return rows;
}

}  // namespace rayloom::bench
