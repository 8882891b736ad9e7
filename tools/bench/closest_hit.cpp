// Single closest-hit rays against Embree in one process: interleaved repetitions, medians and spreads of the ratio, and
// how many hits differ. Usage: rayloom_bench_closest_hit [scene] [size] [repetitions]

#include "peer_embree.h"
#include "ray_sets.h"
#include "triangle_soup.h"

#include <rayloom/accel/trace.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>

namespace rayloom::bench {
namespace {

using Hits = std::vector<accel::Hit>;

template <class Trace>
double mrays_per_second(const std::vector<accel::Ray>& rays, Hits& hits, const Trace& trace) {
  hits.resize(rays.size());
  const auto begin = std::chrono::steady_clock::now();
  for (size_t i = 0; i < rays.size(); ++i) hits[i] = trace(rays[i]);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  return static_cast<double>(rays.size()) / seconds.count() * 1e-6;
}

struct Spread {
  double low, median, high;
};

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), values[values.size() / 2], values.back()};
}

std::vector<double> ratios(const std::vector<double>& ours, const std::vector<double>& theirs) {
  std::vector<double> out;
  for (size_t i = 0; i < ours.size(); ++i) out.push_back(ours[i] / theirs[i]);
  return out;
}

size_t different(const Hits& a, const Hits& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += a[i].type != b[i].type || a[i].primitive_index != b[i].primitive_index;
  return count;
}

void compare(const std::string& name, const std::vector<accel::Ray>& rays, const Structure& structure,
             const Embree& peer, int repetitions) {
  const auto ours = [&](const accel::Ray& ray) {
    return accel::trace({}, {.ray = ray, .structure = structure.block()});
  };
  const auto theirs = [&](const accel::Ray& ray) { return peer.closest_hit(ray); };
  std::vector<double> our_rate, their_rate;
  Hits our_hits, their_hits;
  for (int i = 0; i < repetitions; ++i) {
    our_rate.push_back(mrays_per_second(rays, our_hits, ours));
    their_rate.push_back(mrays_per_second(rays, their_hits, theirs));
  }
  const Spread ratio = spread_of(ratios(our_rate, their_rate));
  fmt::print(
      "{:<20} {:>9} rays  ours {:6.2f}  embree {:6.2f} Mrays/s  ratio {:.2f} ({:.2f} to {:.2f})  different hits {}\n",
      name, rays.size(), spread_of(our_rate).median, spread_of(their_rate).median, ratio.median, ratio.low, ratio.high,
      different(our_hits, their_hits));
  std::fflush(stdout);
}

void run(const std::string& scene, uint32_t size, int repetitions) {
  const TriangleSoup soup = load_soup(scene);
  const Structure structure(soup);
  const std::vector<accel::Ray> primary = primary_rays(scene, size);
  const std::vector<accel::Ray> bounce = bounce_rays(primary, soup, structure);
  fmt::print("{}: {} triangles, {:.1f} bytes/triangle, isa {}, {} repetitions, one thread\n", scene,
             soup.triangle_count(), static_cast<double>(structure.bytes()) / soup.triangle_count(),
             accel::isa_name(accel::current_isa()), repetitions);
  for (const bool robust : {false, true}) {
    const Embree peer(soup, robust);
    const std::string mode = robust ? " vs robust" : " vs high";
    compare("primary" + mode, primary, structure, peer, repetitions);
    compare("bounce" + mode, bounce, structure, peer, repetitions);
  }
}

}  // namespace
}  // namespace rayloom::bench

int main(int argc, char** argv) try {
  const auto number = [&](int i, int fallback) { return argc > i ? std::max(1, std::atoi(argv[i])) : fallback; };
  rayloom::bench::run(argc > 1 ? argv[1] : "atrium", static_cast<uint32_t>(number(2, 512)), number(3, 7));
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "rayloom_bench_closest_hit: {}\n", error.what());
  return 3;
}
