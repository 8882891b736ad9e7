// G1 from end to end: small scenes made to be hard, every ray against every triangle in integers, and the answers of
// every builder, instruction set and way to ask compared bit for bit.

#include "exact_scenes.h"
#include "integer_oracle.h"
#include "rational_oracle.h"
#include "recorder.h"
#include "triangle_cases.h"

#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/layout.h>
#include <rayloom/tests/repetitions.h>

#include <catch2/catch.hpp>

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

InstanceRecord record_of(const Transform3x4& m) {
  InstanceRecord record{};
  std::memcpy(record.object_to_world, m.data(), sizeof(record.object_to_world));
  const auto inverse = invert(record.object_to_world);
  if (inverse) std::memcpy(record.world_to_object, inverse->matrix, sizeof(inverse->matrix));
  return record;
}

bool is_invertible(const Transform3x4& m) {
  float rows[3][4];
  std::copy(m.begin(), m.end(), &rows[0][0]);
  return invert(rows).has_value();
}

/// The scene's hits of one ray with any t > 0, in order of names, in integers.
class Oracle {
 public:
  explicit Oracle(const ExactScene& scene) : scene_(scene) {}

  std::vector<Hit> all_hits(const Ray& ray) const {
    std::vector<Hit> hits;
    if (scene_.instances.empty()) add(hits, ray, 0);
    for (uint32_t i = 0; i < scene_.instances.size(); ++i)
      if (is_invertible(scene_.instances[i])) add(hits, object_ray(record_of(scene_.instances[i]), ray), i);
    return hits;
  }

 private:
  void add(std::vector<Hit>& hits, const Ray& ray, uint32_t instance) const {
    if (!is_traceable(ray)) return;
    for (uint32_t g = 0; g < scene_.geometries.size(); ++g)
      for (uint32_t i = 0; i < scene_.geometries[g].triangles.size(); ++i) {
        const Mesh& mesh = scene_.geometries[g];
        const auto& [a, b, c] = mesh.triangles[i];
        const auto hit = integer_hit(ray, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
        if (!hit || !(hit->t > 0) || std::isinf(hit->t)) continue;
        const uint32_t kind = hit->front ? hit_kind_triangle_front_face : hit_kind_triangle_back_face;
        hits.push_back({hit->t, hit->u, hit->v, instance, g, i, kind, HitType::triangle});
      }
  }

  const ExactScene& scene_;
};

/// A ray and what is true of it.
struct Question {
  Ray ray;
  std::vector<Hit> hits;  ///< with t_min < t < t_max
};

bool in_limits(const Ray& ray, const Hit& hit) { return ray.t_min < hit.t && hit.t < ray.t_max; }

/// Limits at, or a float beside, the t of a hit.
void set_limits(Random& random, Ray& ray, const std::vector<Hit>& hits) {
  if (hits.empty() || random.chance(2)) return;
  const auto near_hit = [&] {
    const float t = hits[random.below(static_cast<uint32_t>(hits.size()))].t;
    const uint32_t beside = random.below(3);
    return beside == 0 ? t : std::nextafter(t, beside == 1 ? 0 : infinity);
  };
  if (random.chance(2)) ray.t_max = near_hit();
  if (random.chance(2)) ray.t_min = std::min(near_hit(), ray.t_max);
}

std::vector<Question> questions_for(const ExactScene& scene, Random& random, size_t count) {
  const Oracle oracle(scene);
  std::vector<Question> questions;
  for (Ray& ray : hard_rays(random, scene, count)) {
    std::vector<Hit> hits = oracle.all_hits(ray);
    set_limits(random, ray, hits);
    std::erase_if(hits, [&](const Hit& hit) { return !in_limits(ray, hit); });
    questions.push_back({ray, std::move(hits)});
  }
  return questions;
}

/// Which hits count for a ray with these flags.
bool counts(const Hit& hit, uint32_t flags) {
  const bool front = hit.hit_kind == hit_kind_triangle_front_face;
  return !(flags & (front ? ray_flag::cull_front_facing_triangles : ray_flag::cull_back_facing_triangles));
}

/// The least t, then the least name: the hits are in order of names.
Hit closest_of(const Question& question, uint32_t flags) {
  Hit closest;
  closest.t = question.ray.t_max;
  for (const Hit& hit : question.hits)
    if (counts(hit, flags) && hit.t < closest.t) closest = hit;
  return closest;
}

bool any_of(const Question& question, uint32_t flags) {
  return std::any_of(question.hits.begin(), question.hits.end(), [&](const Hit& hit) { return counts(hit, flags); });
}

bool is_one_of(const Hit& hit, const std::vector<Hit>& hits) {
  return std::any_of(hits.begin(), hits.end(), [&](const Hit& other) { return same_bits(hit, other); });
}

/// A scene's structures by one builder.
struct Built {
  Block bottom, top;
  const Block& root;

  Built(const ExactScene& scene, const BuildSettings& settings)
      : bottom(build_geometries(geometries(scene), settings)),
        top(build_instances(instances(scene, bottom), settings.flags & ~build_flag::minimize_memory)),
        root(scene.instances.empty() ? bottom : top) {}
  Built(const Built&) = delete;
  Built& operator=(const Built&) = delete;

 private:
  static std::vector<TriangleGeometry> geometries(const ExactScene& scene) {
    std::vector<TriangleGeometry> out;
    for (const Mesh& mesh : scene.geometries)
      out.push_back(mesh.geometry(geometry_flag::opaque | geometry_flag::no_duplicate_anyhit));
    return out;
  }
  static std::vector<InstanceDesc> instances(const ExactScene& scene, const Block& bottom) {
    std::vector<InstanceDesc> out;
    for (const Transform3x4& m : scene.instances) out.push_back(instance_of(bottom, m));
    return out;
  }
};

/// The hits that a candidate function is asked about, in order of names, when it accepts those of odd primitives.
struct Asked {
  std::vector<Hit> candidates;
  Hit result;
};

Asked ask(const Block& block, const Question& question, bool accept_odd) {
  Recorder recorder([&](const Candidate& c) { return Verdict{accept_odd && c.primitive_index % 2 == 1}; });
  Asked asked;
  asked.result = trace({}, recorder.request(block, question.ray, ray_flag::force_non_opaque));
  for (const Candidate& c : recorder.candidates)
    asked.candidates.push_back(
        {c.t, c.u, c.v, c.instance_index, c.geometry_index, c.primitive_index, c.hit_kind, HitType::triangle});
  return asked;
}

/// Counts of answers that differ from the truth, by the way of asking.
struct Differences {
  size_t one = 0, requests = 0, shared = 0, occlusion = 0, first = 0, candidates = 0, accepted = 0;
  size_t sum() const { return one + requests + shared + occlusion + first + candidates + accepted; }
};

std::vector<Ray> rays_of(const std::vector<Question>& questions) {
  std::vector<Ray> rays;
  for (const Question& question : questions) rays.push_back(question.ray);
  return rays;
}

void ask_closest(const Block& block, const std::vector<Question>& questions, uint32_t flags, Differences& differences) {
  const auto rays = rays_of(questions);
  const TraceRequest shared = request_for(block, rays[0], flags);
  std::vector<TraceRequest> requests;
  for (const Ray& ray : rays) requests.push_back(request_for(block, ray, flags));
  std::vector<Hit> in_requests(rays.size()), in_run(rays.size());
  trace({}, requests, in_requests);
  trace({}, shared, rays, in_run);
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = closest_of(questions[i], flags);
    differences.one += !same_bits(trace({}, requests[i]), expected);
    differences.requests += !same_bits(in_requests[i], expected);
    differences.shared += !same_bits(in_run[i], expected);
  }
}

void ask_any(const Block& block, const std::vector<Question>& questions, uint32_t flags, Differences& differences) {
  const auto rays = rays_of(questions);
  const uint32_t first_flags = flags | ray_flag::accept_first_hit_and_end_search;
  std::vector<uint8_t> results(rays.size());
  std::vector<Hit> first(rays.size());
  occluded({}, request_for(block, rays[0], flags), rays, results);
  trace({}, request_for(block, rays[0], first_flags), rays, first);
  for (size_t i = 0; i < rays.size(); ++i) {
    const bool expected = any_of(questions[i], flags);
    differences.occlusion += results[i] != static_cast<uint8_t>(expected);
    for (const Hit& hit : {first[i], trace({}, request_for(block, rays[i], first_flags))})
      differences.first += expected ? !is_one_of(hit, questions[i].hits) : static_cast<bool>(hit);
  }
}

void ask_candidates(const Block& block, const std::vector<Question>& questions, Differences& differences) {
  for (const Question& question : questions) {
    const Asked all = ask(block, question, false);
    bool same = !all.result && all.candidates.size() == question.hits.size();
    for (const Hit& hit : question.hits) same &= is_one_of(hit, all.candidates);
    differences.candidates += !same;
    Question odd = question;
    std::erase_if(odd.hits, [](const Hit& hit) { return hit.primitive_index % 2 == 0; });
    differences.accepted += !same_bits(ask(block, question, true).result, closest_of(odd, 0));
  }
}

/// Every way of asking, on every instruction set.
void check(const Block& block, const std::vector<Question>& questions) {
  for_each_isa([&](Isa isa) {
    Differences differences;
    for (const uint32_t flags : {ray_flag::none, ray_flag::cull_back_facing_triangles,
                                 ray_flag::cull_front_facing_triangles | ray_flag::force_opaque}) {
      ask_closest(block, questions, flags, differences);
      ask_any(block, questions, flags, differences);
    }
    ask_candidates(block, questions, differences);
    if (differences.sum() == 0) return;
    CAPTURE(isa_name(isa), differences.one, differences.requests, differences.shared, differences.occlusion,
            differences.first, differences.candidates, differences.accepted);
    FAIL_CHECK("answers that differ from the integers'");
  });
}

std::vector<BuildSettings> some_settings(Random& random) {
  std::vector<BuildSettings> all;
  const uint32_t flags[] = {build_flag::none, build_flag::prefer_fast_trace, build_flag::prefer_fast_build,
                            build_flag::minimize_memory, build_flag::allow_update};
  all.emplace_back(flags[random.below(5)]);
  for (const Builder builder : all_builders()) all.emplace_back(flags[random.below(5)], builder, random.chance(2));
  return all;
}

/// How much of a scene's questions say something.
struct Interest {
  size_t rays = 0, with_hits = 0, ties = 0, on_edges = 0;

  void add(const std::vector<Question>& questions) {
    for (const Question& q : questions) {
      ++rays;
      with_hits += !q.hits.empty();
      for (size_t i = 0; i < q.hits.size(); ++i) {
        const Hit& hit = q.hits[i];
        on_edges += hit.u == 0 || hit.v == 0;
        for (size_t k = 0; k < i; ++k) ties += q.hits[k].t == hit.t;
      }
    }
  }
};

}  // namespace

TEST_CASE("hard scenes are answered as integers answer, whoever builds and however one asks") {
  Interest all;
  for (const SceneMaker make : all_exact_scenes) {
    Interest here;
    for (uint64_t round = 0; round < static_cast<uint64_t>(rayloom::test::repetitions(12)); ++round) {
      Random random(100 * round + 7);
      ExactScene scene = make(random);
      const bool is_ordinary = scene.reach >= 1 && scene.reach <= 100;
      if (is_ordinary && round % 2 == 1)
        scene = scaled(scene, std::ldexp(1.0f, static_cast<int>(random.below(60)) - 32));  // to 2^32 and beyond
      const auto questions = questions_for(scene, random, 96);
      here.add(questions);
      all.add(questions);
      for (const BuildSettings& settings : some_settings(random)) {
        CAPTURE(scene.name, round, builder_name(settings.builder), settings.flags);
        const Built built(scene, settings);
        check(built.root, questions);
      }
    }
    CHECK(here.with_hits > here.rays / 20);
  }
  CHECK(all.with_hits > all.rays / 3);
  CHECK(all.ties > static_cast<size_t>(rayloom::test::repetitions(1000)));
  CHECK(all.on_edges > static_cast<size_t>(rayloom::test::repetitions(500)));
}

TEST_CASE("an instance's ray is the exact one, rounded, up to the conditioning's share") {
  Random random(9);
  size_t exact = 0, rays = 0;
  for (int i = 0; i < 3000; ++i) {
    const Transform3x4 m = hard_transform(random);
    if (!is_invertible(m)) continue;
    const InstanceRecord record = record_of(m);
    const Ray world = ray_between(point_in(random, 4), point_in(random, 4));
    const Ray object = object_ray(record, world);
    mpq_class a[3][3], determinant = 0, norm = 0, inverse_norm = 0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) a[r][c] = m[4 * r + c];
    const auto minor = [&](int r, int c) -> mpq_class {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      return a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1];
    };
    for (int k = 0; k < 3; ++k) determinant += a[0][k] * minor(0, k);
    mpq_class origin[3], direction[3], reach = 0;
    for (int r = 0; r < 3; ++r) {
      mpq_class row = 0, inverse_row = 0;
      for (int c = 0; c < 3; ++c) {
        const mpq_class w = minor(c, r) / determinant;
        origin[r] += w * (mpq_class(world.origin[c]) - mpq_class(m[4 * c + 3]));
        direction[r] += w * mpq_class(world.direction[c]);
        row += abs(a[r][c]);
        inverse_row += abs(w);
        reach = std::max(reach, mpq_class(abs(mpq_class(world.origin[c]) - mpq_class(m[4 * c + 3]))));
      }
      norm = std::max(norm, row);
      inverse_norm = std::max(inverse_norm, inverse_row);
    }
    for (int k = 0; k < 3; ++k) {
      const mpq_class slack = mpq_class(0x1p-49) * norm * inverse_norm * inverse_norm * (reach + 8);
      const auto near = [&](float got, const mpq_class& wanted) {
        const mpq_class half = abs(mpq_class(got)) * mpq_class(0x1p-24) + mpq_class(0x1p-150);
        return abs(mpq_class(got) - wanted) <= half + slack;
      };
      CHECK(near(object.origin[k], origin[k]));
      CHECK(near(object.direction[k], direction[k]));
      exact += is_nearest(object.origin[k], origin[k]) + is_nearest(object.direction[k], direction[k]);
      rays += 2;
    }
  }
  CHECK(exact > rays * 9 / 10);
}

TEST_CASE("the integer oracle agrees with the rational one, and rounds") {
  CHECK(nearest_float(1, 3) == 1.0f / 3);
  CHECK(nearest_float(-1, 3) == -1.0f / 3);
  CHECK(nearest_float((1 << 24) + 1, 1) == 0x1p24f);      // a tie, to even
  CHECK(nearest_float((1 << 24) + 3, 1) == 0x1p24f + 4);  // a tie, to even
  CHECK(nearest_float(mpz_class(1), mpz_class(1) << 150) == 0);
  CHECK(nearest_float(mpz_class(3), mpz_class(1) << 150) == 0x1p-148f);
  CHECK(nearest_float(mpz_class(1) << 128, 1) == infinity);
  CHECK(nearest_float((mpz_class(1) << 128) - (mpz_class(1) << 103) - 1, 1) == std::numeric_limits<float>::max());
  Random random(10);
  size_t hits = 0, different = 0;
  for (int i = 0; i < 20000; ++i) {
    const Family family = all_families[random.below(static_cast<uint32_t>(all_families.size()))];
    const Case c = random_case(random, family);
    const auto ours = integer_hit(c.ray, c.triangle);
    const auto theirs = rational_hit(c.ray, c.triangle);
    if (ours.has_value() != theirs.has_value()) ++different;
    if (!ours || !theirs) continue;
    ++hits;
    different += !is_nearest(ours->t, theirs->t) || !is_nearest(ours->u, theirs->u) ||
                 !is_nearest(ours->v, theirs->v) || ours->front != theirs->front;
  }
  CHECK(different == 0);
  CHECK(hits > 5000);
}
