#pragma once

// What a trace has found so far, and the one rule by which a hit replaces another. Since the rule orders hits totally
// (G3b), the closest hit does not depend on the order in which a tree offers them.

#include <rayloom/accel/asked_triangles.h>
#include <rayloom/accel/instance_rules.h>
#include <rayloom/accel/trace.h>
#include <rayloom/accel/triangle.h>

#include <memory>
#include <tuple>

namespace rayloom::accel {

/// Where a hit is; ordered by instance, then geometry, then primitive.
struct HitName {
  uint32_t instance, geometry, primitive;
  auto operator<=>(const HitName&) const = default;
};

inline HitName name_of(const Hit& hit) { return {hit.instance_index, hit.geometry_index, hit.primitive_index}; }

/// A procedural beats a triangle at the same t; among triangles the smallest name wins, among procedurals the largest.
/// Before any hit, t is the ray's t_max: exclusive for triangles, inclusive for procedurals (EXT-01, EXT-02).
inline bool triangle_wins_tie(const Hit& committed, const HitName& name) {
  return committed.type == HitType::triangle && name < name_of(committed);
}
inline bool procedural_wins_tie(const Hit& committed, const HitName& name) {
  return committed.type != HitType::procedural || name >= name_of(committed);
}

/// What became of a primitive offered to the search.
enum class Offer : uint8_t { rejected, committed, ended };

class Search {
 public:
  Search() = default;  ///< of nothing, to be assigned to
  explicit Search(const TraceRequest& request) : Search(request, request.ray) {}
  /// `ray` instead of the request's own.
  Search(const TraceRequest& request, const Ray& ray) : request_(&request), ray_(&ray) { hit_.t = ray.t_max; }
  /// One that has found `hit`, or nothing yet up to hit.t.
  Search(const TraceRequest& request, const Ray& ray, const Hit& hit) : request_(&request), ray_(&ray), hit_(hit) {}

  /// Begins anew with `ray`, for requests without candidate function.
  void restart(const Ray& ray) {
    ray_ = &ray;
    hit_ = Hit{.t = ray.t_max};
  }

  const TraceRequest& request() const { return *request_; }
  const Ray& ray() const { return *ray_; }
  const Hit& hit() const { return hit_; }
  float t() const { return hit_.t; }

  /// A triangle hit inside (t_min, t()], t() included so that the tie rule can decide.
  template <class Visitor>
  Offer offer_triangle(const InstanceRules& rules, uint32_t geometry_word, uint32_t primitive, const TriangleHit& hit,
                       Visitor& visitor) {
    const HitName name{rules.instance_index, geometry_index(geometry_word), primitive};
    if (hit.t == hit_.t && !triangle_wins_tie(hit_, name)) return Offer::rejected;
    const Outcome outcome = rules.outcome_of(geometry_word);
    if (rules.hits.culled_facing[shows_front(hit, rules)] || outcome == Outcome::cull) return Offer::rejected;
    const Hit found = found_at(name, hit, rules);
    if (outcome == Outcome::commit || !request_->candidate) return commit(found);
    if ((geometry_word >> 24 & geometry_flag::split) && !is_new(name)) return Offer::rejected;
    const Verdict verdict = ask(found, rules, false, false, visitor);
    if (verdict.commit) commit(found);
    return after(verdict.commit, verdict.end_search);
  }

  /// The same where no triangle is culled or asked for: HitRules::accepts_all, no candidate function.
  [[gnu::always_inline]] Offer offer_accepted(const InstanceRules& rules, uint32_t geometry_word, uint32_t primitive,
                                              const TriangleHit& hit) {
    const HitName name{rules.instance_index, geometry_index(geometry_word), primitive};
    if (hit.t == hit_.t && !triangle_wins_tie(hit_, name)) return Offer::rejected;
    return commit(found_at(name, hit, rules));
  }

  /// A procedural primitive whose box the ray may meet.
  template <class Visitor>
  Offer offer_procedural(const InstanceRules& rules, uint32_t geometry_word, uint32_t primitive, Visitor& visitor) {
    const Outcome outcome = rules.outcome_of(geometry_word);
    if (outcome == Outcome::cull) return Offer::rejected;
    const HitName name{rules.instance_index, geometry_index(geometry_word), primitive};
    const bool wins_ties = procedural_wins_tie(hit_, name);
    Hit found{0, 0, 0, name.instance, name.geometry, name.primitive, 0, HitType::procedural};
    const Verdict verdict = ask(found, rules, outcome == Outcome::commit, wins_ties, visitor);
    const bool in_range = verdict.t >= ray_->t_min && (wins_ties ? verdict.t <= hit_.t : verdict.t < hit_.t);
    const bool commits = verdict.commit && in_range;
    if (commits) {
      found.t = verdict.t;
      found.hit_kind = verdict.hit_kind;
      commit(found);
    }
    return after(commits, verdict.end_search);
  }

 private:
  static bool shows_front(const TriangleHit& hit, const InstanceRules& rules) {
    return hit.front != rules.hits.swap_facing;
  }

  [[gnu::always_inline]] static Hit found_at(const HitName& name, const TriangleHit& hit, const InstanceRules& rules) {
    const uint32_t kind = shows_front(hit, rules) ? hit_kind_triangle_front_face : hit_kind_triangle_back_face;
    return {hit.t, hit.u, hit.v, name.instance, name.geometry, name.primitive, kind, HitType::triangle};
  }

  /// Of a triangle that other leaves may name too: whether this ray has not asked for it yet (AH rows).
  [[gnu::noinline, gnu::cold]] bool is_new(const HitName& name) {
    if (!asked_) asked_ = std::make_unique<AskedTriangles>();
    return asked_->is_new({name.instance, name.geometry, name.primitive});
  }

  template <class Visitor>
  Verdict ask(const Hit& found, const InstanceRules& rules, bool opaque, bool wins_ties, Visitor& visitor) {
    const Candidate candidate{found.type,
                              found.instance_index,
                              found.geometry_index,
                              found.primitive_index,
                              found.t,
                              found.u,
                              found.v,
                              found.hit_kind,
                              opaque,
                              hit_.t,
                              wins_ties,
                              rules.instance};
    const Verdict verdict = request_->candidate(request_->user, candidate);
    visitor.on_candidate(candidate, verdict);
    return verdict;
  }

  Offer commit(const Hit& found) {
    hit_ = found;
    return after(true, false);
  }

  Offer after(bool committed, bool end_search) const {
    const bool first_ends = request_->ray_flags & ray_flag::accept_first_hit_and_end_search;
    if (end_search || (committed && first_ends)) return Offer::ended;
    return committed ? Offer::committed : Offer::rejected;
  }

  const TraceRequest* request_ = nullptr;
  const Ray* ray_ = nullptr;
  Hit hit_;
  std::unique_ptr<AskedTriangles> asked_;  ///< made for the first split triangle that is asked for
};

}  // namespace rayloom::accel
