#include <rayloom/tools/bench/traversal/contest.h>

#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::bench {
namespace {

using Hits = std::vector<accel::Hit>;

constexpr uint64_t judged_at_most = 20000;

bool same_answer(const accel::Hit& a, const accel::Hit& b, bool any_hit) {
  if (any_hit || a.type != b.type) return a.type == b.type;
  return a.instance_index == b.instance_index && a.primitive_index == b.primitive_index;
}

/// Instances are 0 for us too where there are none.
bool same_bits(const accel::Hit& a, const accel::Hit& b, bool any_hit) {
  return same_answer(a, b, any_hit) && (any_hit || (a.t == b.t && a.u == b.u && a.v == b.v));
}

void count(Differences& differences, Verdict verdict) {
  ++differences.total;
  switch (verdict) {
    case Verdict::ours:
      ++differences.ours_exact;
      break;
    case Verdict::theirs:
      ++differences.theirs_exact;
      break;
    case Verdict::tie:
      ++differences.ties;
      break;
    case Verdict::undecided:
      ++differences.undecided;
      break;
  }
}

/// The closest hits of both for one ray: what an any-hit answer rests on.
Verdict judge_any_hit(const BenchScene& scene, const OurStructure& structure, const Peer& peer, const accel::Ray& ray) {
  const accel::Hit ours = accel::trace({}, structure.request(ray));
  accel::Hit theirs;
  peer.closest_hits({&ray, 1}, {&theirs, 1});
  if (!ours && !theirs) return Verdict::undecided;
  return judge(scene, ray, ours, theirs);
}

Differences find_differences(const Contest& contest, const BenchScene& scene, const OurStructure& structure,
                             const Peer& peer, const Hits& ours, const Hits& theirs) {
  Differences differences;
  for (size_t i = 0; i < ours.size(); ++i) {
    if (same_answer(ours[i], theirs[i], contest.any_hit)) continue;
    const accel::Ray& ray = (*contest.rays)[i];
    if (differences.total >= judged_at_most) {
      count(differences, Verdict::undecided);
    } else {
      count(differences,
            contest.any_hit ? judge_any_hit(scene, structure, peer, ray) : judge(scene, ray, ours[i], theirs[i]));
    }
  }
  return differences;
}

}  // namespace

ContestResult run_contest(const Contest& contest, const BenchScene& scene, const OurStructure& structure,
                          std::span<const std::unique_ptr<Peer>> peers, const ContestSettings& settings) {
  std::vector<Contestant> all(contest.ours);
  all.insert(all.end(), contest.peers.begin(), contest.peers.end());
  std::vector<Hits> hits(all.size(), Hits(contest.rays->size()));
  std::vector<Measurand> measurands;
  for (size_t i = 0; i < all.size(); ++i) {
    const unsigned threads = all[i].collect ? 1 : settings.threads;
    const auto run = [&, i, threads] { trace_all(all[i].trace, *contest.rays, hits[i], threads); };
    measurands.push_back({all[i].name, run, static_cast<double>(contest.rays->size())});
  }
  const ThreadLimit limit(settings.threads);
  const Clock clock = settings.threads == 1 ? Clock::thread_cpu : Clock::wall;
  std::vector<Measured> measured = measure_interleaved(measurands, settings.repetitions, clock,
                                                       settings.progress ? scene.name + " " + contest.set : "");
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i].collect) hits[i] = all[i].collect();
  }
  const auto middle = measured.begin() + static_cast<ptrdiff_t>(contest.ours.size());
  ContestResult result{{measured.begin(), middle}, {middle, measured.end()}, 0, 0, {}};
  uint64_t hit = 0;
  for (size_t i = 0; i < contest.rays->size(); ++i) {
    hit += bool{hits[0][i]};
    for (size_t k = 1; k < contest.ours.size(); ++k) {
      result.disagreeing_modes += !same_bits(hits[0][i], hits[k][i], contest.any_hit);
    }
  }
  result.hit_share = static_cast<double>(hit) / static_cast<double>(std::max<size_t>(1, contest.rays->size()));
  for (size_t k = 0; k < contest.peers.size(); ++k) {
    result.differences.push_back(
        find_differences(contest, scene, structure, *peers[k], hits[0], hits[contest.ours.size() + k]));
  }
  return result;
}

}  // namespace rayloom::bench
