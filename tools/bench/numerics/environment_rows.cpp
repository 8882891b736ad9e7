// K21, K22: whatever the caller's floating-point state, the bits of a hit stay the same.

#include <rayloom/tests/accel/structures.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <rayloom/base/float_environment.h>

#include <cfenv>
#include <chrono>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace rayloom::bench::numerics {
namespace {

/// A state to call the library in; restored on leaving.
class CallerState {
 public:
  explicit CallerState(uint32_t mxcsr) {
#if defined(__x86_64__)
    before_ = _mm_getcsr();
    _mm_setcsr(mxcsr);
#else
    (void)mxcsr;
#endif
  }
  ~CallerState() {
#if defined(__x86_64__)
    _mm_setcsr(before_);
#endif
  }
  CallerState(const CallerState&) = delete;
  CallerState& operator=(const CallerState&) = delete;

 private:
  uint32_t before_ = 0;
};

struct NamedState {
  const char* name;
  uint32_t mxcsr;
};

constexpr uint32_t masked = 0x1F80, flush = 0x8000, denormals_are_zero = 0x0040;
constexpr NamedState flushes[] = {
    {"default", masked}, {"FTZ", masked | flush}, {"FTZ+DAZ", masked | flush | denormals_are_zero}};
constexpr NamedState roundings[] = {{"down", masked | 0x2000}, {"up", masked | 0x4000}, {"to zero", masked | 0x6000}};

struct Shots {
  std::unique_ptr<MeshTracer> tracer;
  std::vector<Ray> rays;
};

/// Vertex rays at a sphere of the given size.
Shots shots_at(const Subject& subject, float scale, uint64_t rays, uint64_t seed) {
  const Mesh mesh = accel::test::moved(accel::test::icosphere(2), scale, 0);
  Shots shots{subject.tracer({mesh}), {}};
  Random random(seed);
  for (uint64_t i = 0; i < rays; ++i) {
    const Point& to = mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))];
    Point from{random.uniform(-scale, scale), random.uniform(-scale, scale), random.uniform(-scale, scale)};
    shots.rays.push_back(ray_between(from, to));
  }
  return shots;
}

std::vector<accel::Hit> trace_all(const Shots& shots) {
  std::vector<accel::Hit> hits;
  for (const Ray& ray : shots.rays) hits.push_back(shots.tracer->closest(ray));
  return hits;
}

uint64_t differences(const std::vector<accel::Hit>& a, const std::vector<accel::Hit>& b) {
  uint64_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += !accel::test::same_bits(a[i], b[i]);
  return count;
}

double seconds_of(const Shots& shots) {
  const auto start = std::chrono::steady_clock::now();
  trace_all(shots);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Hits in every state against those of the fixed one, at ordinary and tiny scales, and with a state that changes from
/// call to call.
void compare_states(RowRun& run, std::span<const NamedState> states) {
  uint64_t different = 0, rays = 0;
  for (const float scale : {1.0f, 1e-12f, 1e-15f, 1e-19f, 0x1p-100f}) {
    const Shots shots = shots_at(run.subject, scale, run.slow(5000).count, run.seed());
    const FloatEnvironment environment;
    const auto expected = trace_all(shots);
    for (const NamedState& state : states) {
      const CallerState caller(state.mxcsr);
      different += differences(trace_all(shots), expected);
      rays += shots.rays.size();
    }
    for (size_t i = 0; i < shots.rays.size(); ++i, ++rays) {
      const CallerState caller(states[i % states.size()].mxcsr);
      different += !accel::test::same_bits(shots.tracer->closest(shots.rays[i]), expected[i]);
    }
  }
  run.none("hits that differ from those of the fixed state", different, rays);
}

}  // namespace

void run_flush_to_zero(RowRun& run) {
  compare_states(run, flushes);
  const Shots unit = shots_at(run.subject, 1, run.slow(2000).count, run.seed());
  const Shots tiny = shots_at(run.subject, 1e-19f, run.slow(2000).count, run.seed());
  const double plain = seconds_of(unit);
  run.report("time at scale 1e-19 over time at scale 1", seconds_of(tiny) / plain, "x (a time: not gated)");
}

void run_rounding_modes(RowRun& run) { compare_states(run, roundings); }

}  // namespace rayloom::bench::numerics
