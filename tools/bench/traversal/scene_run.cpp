#include <rayloom/tools/bench/traversal/scene_run.h>

#include <rayloom/base/parallel.h>
#include <rayloom/tools/bench/instructions.h>

#include <map>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

using accel::ray_flag::accept_first_hit_and_end_search;
using accel::ray_flag::skip_closest_hit_shader;

constexpr uint32_t any_hit_flags = accept_first_hit_and_end_search | skip_closest_hit_shader;

/// What is traced in a scene: our structure, the peers' and the rays.
struct Setting {
  explicit Setting(const std::string& name, const TraversalOptions& options)
      : scene(load_bench_scene(name, options.scenes_directory, options.largest_flat)),
        structure(scene),
        sets(make_ray_sets(scene, structure, static_cast<uint32_t>(options.size))) {
    if (!options.against_embree) return;
    for (const bool robust : {false, true}) {
      EmbreeOptions peer{EmbreeQuality::high, robust};
      peer.threads = thread_limit();
      peer.avx2 = options.avx2;
      peers.push_back(make_embree(scene.peer(), peer));
      peer_names.push_back(describe(peer));
    }
  }

  BenchScene scene;
  OurStructure structure;
  RaySets sets;
  std::vector<std::unique_ptr<Peer>> peers;
  std::vector<std::string> peer_names;
};

using PeerCall = void (Peer::*)(std::span<const accel::Ray>, std::span<accel::Hit>) const;

enum Ways : unsigned { batches = 1, warps = 2, singles = 4 };

Contest make_contest(const Setting& setting, const TraversalOptions& options, const char* set, const Rays& rays,
                     unsigned ways, bool any_hit, const char* peer_call, PeerCall call) {
  const uint32_t flags = any_hit ? any_hit_flags : 0;
  Contest contest{set, peer_call, &rays, any_hit, {}, {}};
  if (ways & batches) contest.ours.push_back({batch_mode, trace_in_batches(setting.structure, flags, options.batch)});
  if (ways & warps) contest.ours.push_back({warp_mode, trace_in_batches(setting.structure, flags, 32)});
  if (ways & singles) contest.ours.push_back({single_mode, trace_one_by_one(setting.structure, flags)});
  for (size_t i = 0; i < setting.peers.size(); ++i) {
    const Peer& peer = *setting.peers[i];
    contest.peers.push_back({setting.peer_names[i], [&peer, call](auto r, auto h) { (peer.*call)(r, h); }});
  }
  return contest;
}

/// Primary rays through the runtime, beside the batch interface and the peer's packets.
void add_dispatch(Contest& primary, DispatchBench& dispatch) {
  primary.ours.push_back(
      {dispatch_mode, [&](auto, auto) { dispatch.run(DispatchPart::whole); }, [&] { return dispatch.hits(); }});
}

std::vector<Contest> make_contests(const Setting& s, const TraversalOptions& o) {
  constexpr PeerCall closest = &Peer::closest_hits, any = &Peer::any_hits, packets = &Peer::closest_hits_16;
  return {make_contest(s, o, "primary", s.sets.primary, batches | warps, false, "rtcIntersect16", packets),
          make_contest(s, o, "primary", s.sets.primary, singles, false, "rtcIntersect1", closest),
          make_contest(s, o, "bounce", s.sets.bounce, batches | warps | singles, false, "rtcIntersect1", closest),
          make_contest(s, o, "bounce, shuffled", s.sets.shuffled, batches | warps, false, "rtcIntersect1", closest),
          make_contest(s, o, "ambient occlusion", s.sets.ambient, batches | warps, true, "rtcOccluded1", any),
          make_contest(s, o, "shadow", s.sets.shadow, batches | warps, true, "rtcOccluded1", any)};
}

/// A row each of our ways. Differences are those of the first: the others give the same bits, or this throws.
void append_rows(std::vector<TraversalRow>& rows, const Contest& contest, const ContestResult& result,
                 const std::string& scene, unsigned threads) {
  if (result.disagreeing_modes) {
    throw std::runtime_error(fmt::format("{}: {} {} rays have different hits one at a time and in batches", scene,
                                         result.disagreeing_modes, contest.set));
  }
  for (const Measured& ours : result.ours) {
    TraversalRow row{scene,   contest.set,          ours.name,        contest.peer_call,
                     threads, contest.rays->size(), result.hit_share, ours.rate(),
                     {}};
    for (size_t i = 0; i < result.peers.size(); ++i) {
      const Measured& peer = result.peers[i];
      row.peers.push_back({peer.name, peer.rate(), speed_ratio(ours, peer), result.differences[i]});
    }
    rows.push_back(row);
  }
}

/// The bounce rays on a structure built small, beside the same on a usual one. Both are built now: of two built far
/// apart one may lie in huge pages and the other not, which is 4 to 8 %.
MemoryRow minimized_memory(const Setting& setting, const TraversalOptions& options) {
  const OurStructure full(setting.scene), small(setting.scene, accel::build_flag::minimize_memory);
  Contest contest{"bounce, small", "", &setting.sets.bounce, false, {}, {}};
  contest.ours = {{"full speed", trace_in_batches(full, 0, options.batch)},
                  {"small", trace_in_batches(small, 0, options.batch)}};
  const ContestResult result =
      run_contest(contest, setting.scene, setting.structure, {}, {1, options.repetitions, options.progress});
  if (result.disagreeing_modes) throw std::runtime_error("hits differ between trees: " + setting.scene.name);
  return {setting.scene.name, "ours, MINIMIZE_MEMORY", setting.scene.stored_triangles(), small.bytes(),
          speed_ratio(result.ours[1], result.ours[0])};
}

std::string region(const std::string& set, const std::string& peer_call, const std::string& way) {
  return set + "; " + peer_call + "; " + way;
}

/// Instructions a ray by region, of the same rays in a smaller picture.
std::map<std::string, double> count_instructions_per_ray(const std::string& scene, const TraversalOptions& options) {
  std::vector<std::string> arguments{"bench",   "traversal",
                                     scene,     "--count-rays",
                                     "--isa",   "avx2",
                                     "--size",  std::to_string(options.counted_size),
                                     "--batch", std::to_string(options.batch)};
  if (options.against_embree) arguments.insert(arguments.end(), {"--against", "embree"});
  if (options.largest_flat == 0) arguments.push_back("--two-level");
  if (!options.scenes_directory.empty()) arguments.insert(arguments.end(), {"--scenes-dir", options.scenes_directory});
  const CountedRun run = count_instructions(arguments);
  std::map<std::string, double> counts;
  std::istringstream lines(run.out);
  double rays = 0;
  for (std::string name; lines >> rays && std::getline(lines >> std::ws, name);) {
    counts[name] = static_cast<double>(run.regions.at(name)) / rays;
  }
  return counts;
}

void add_instructions(std::vector<TraversalRow>& rows, const std::map<std::string, double>& counts) {
  const auto count = [&](const TraversalRow& row, const std::string& way) {
    const auto found = counts.find(region(row.set, row.peer_call, way));
    return found == counts.end() ? 0 : found->second;
  };
  for (TraversalRow& row : rows) {
    row.instructions_per_ray = count(row, row.mode);
    for (PeerRow& peer : row.peers) peer.instructions_per_ray = count(row, peer.peer);
  }
}

}  // namespace

void count_scene(const TraversalOptions& options) {
  const ThreadLimit one_thread(1);
  const Setting setting(options.scenes.front(), options);
  for (const Contest& contest : make_contests(setting, options)) {
    std::vector<accel::Hit> hits(contest.rays->size());
    std::vector<Contestant> all(contest.ours);
    all.insert(all.end(), contest.peers.begin(), contest.peers.end());
    for (const Contestant& contestant : all) {
      const std::string name = region(contest.set, contest.peer_call, contestant.name);
      count_region(name, [&] { contestant.trace(*contest.rays, hits); });
      fmt::print("{} {}\n", contest.rays->size(), name);
    }
  }
}

SceneResult run_scene(const std::string& name, const TraversalOptions& options) {
  const Setting setting(name, options);
  DispatchBench dispatch(setting.scene, setting.sets.primary);
  SceneResult result;
  for (const unsigned threads : options.threads) {
    std::vector<Contest> contests = make_contests(setting, options);
    add_dispatch(contests.front(), dispatch);
    for (const Contest& contest : contests) {
      const ContestResult measured = run_contest(contest, setting.scene, setting.structure, setting.peers,
                                                 {threads, options.repetitions, options.progress});
      append_rows(result.rows, contest, measured, setting.scene.name, threads);
    }
  }
  if (options.instructions) add_instructions(result.rows, count_instructions_per_ray(name, options));
  for (const unsigned threads : options.threads) {
    result.breakdowns.push_back(
        {name, threads, measure_breakdown(dispatch, setting.sets.primary.size(), threads, options.repetitions)});
  }
  const uint64_t triangles = setting.scene.stored_triangles();
  result.memory.push_back({name, "ours", triangles, setting.structure.bytes(), {}});
  result.memory.push_back(minimized_memory(setting, options));
  for (size_t i = 0; i < setting.peers.size(); ++i) {
    result.memory.push_back({name, "Embree " + setting.peer_names[i], triangles, setting.peers[i]->bytes(), {}});
  }
  return result;
}

}  // namespace rayloom::bench
