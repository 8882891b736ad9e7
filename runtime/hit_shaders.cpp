#include <rayloom/runtime/ray_frame.h>
#include <rayloom/runtime/run_shader.h>

#include <cmath>

namespace rayloom::detail {
namespace {

/// What an intersection shader works on, behind its Invocation.
struct IntersectionInvocation : Invocation {
  RayFrame* frame = nullptr;
  const HitGroup* group = nullptr;
  Primitive* candidate = nullptr;
  bool opaque = false;
  bool wins_ties = true;  // at the t committed before this invocation (G3b)
  bool accepted = false, ended = false;
  float accepted_t = 0;
  uint accepted_kind = 0;
};

/// Accesses on the tracing thread belong to this lane while one of its shaders runs there.
class ObservedLane {
 public:
  explicit ObservedLane(const Lane& lane) : outer_(shader_memory.observer) {
    if (lane.dispatch().observed) shader_memory.observer = &lane.observer;
  }
  ~ObservedLane() { shader_memory.observer = outer_; }
  ObservedLane(const ObservedLane&) = delete;
  ObservedLane& operator=(const ObservedLane&) = delete;

 private:
  const LaneObserver* outer_;
};

/// Runs any-hit if the group has one that can run; a group without accepts (OP-11).
HitDecision run_any_hit(Invocation& invocation, RayFrame& frame, const HitGroup& group, const void* attributes,
                        const TypeInfo& attribute_type) {
  const uint32_t shader = group.any_hit;
  if (shader == no_shader || !takes_payload(frame, shader)) return HitDecision::accept;
  const Pipeline& pipeline = frame.lane->dispatch().pipeline;
  if (!(pipeline.code[shader].attributes == attribute_type)) {
    frame.lane->report("IS-14",
                       [&] { return "any-hit shader '" + pipeline.shaders[shader].name + "' takes other attributes"; });
    return HitDecision::accept;
  }
  return run_shader(invocation, shader, frame.payload, attributes);
}

bool ends_search(const RayFrame& frame, HitDecision decision) {
  return decision == HitDecision::accept_and_end_search ||
         (frame.arguments->flags & RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH) != 0;
}

Primitive primitive_of(const accel::Candidate& candidate, const accel::InstanceRecord& instance) {
  return {&instance, candidate.instance_index, candidate.geometry_index, candidate.primitive_index, candidate.hit_kind};
}

const HitGroup* group_of(const RayFrame& frame, const SelectedRecord& selected) {
  return selected.target ? &frame.lane->dispatch().pipeline.hit_groups[selected.target->index] : nullptr;
}

bool has_type(const RayFrame& frame, const HitGroup& group, HIT_GROUP_TYPE type) {
  if (group.type == type) return true;
  frame.lane->report("ST-20", [&] { return "hit group '" + group.name + "' does not fit the primitive it is for"; });
  return false;
}

accel::Verdict decide_triangle(RayFrame& frame, const accel::Candidate& candidate,
                               const accel::InstanceRecord& instance) {
  const SelectedRecord selected = frame.hit_record(instance, candidate.geometry_index);
  const HitGroup* const group = group_of(frame, selected);
  if (!group) return {.commit = true, .end_search = ends_search(frame, HitDecision::accept)};  // ST-14
  if (!has_type(frame, *group, HIT_GROUP_TYPE_TRIANGLES)) return {};
  const Primitive primitive = primitive_of(candidate, instance);
  const BuiltInTriangleIntersectionAttributes attributes{float2(candidate.u, candidate.v)};
  Invocation invocation{frame.lane, frame.arguments, &primitive, candidate.t, frame.record_at(selected.address)};
  const HitDecision decision =
      run_any_hit(invocation, frame, *group, &attributes, type_info_of<BuiltInTriangleIntersectionAttributes>());
  if (decision == HitDecision::ignore) return {};
  return {.commit = true, .end_search = ends_search(frame, decision)};
}

accel::Verdict decide_procedural(RayFrame& frame, const accel::Candidate& candidate,
                                 const accel::InstanceRecord& instance) {
  const SelectedRecord selected = frame.hit_record(instance, candidate.geometry_index);
  const HitGroup* const group = group_of(frame, selected);
  if (!group || !has_type(frame, *group, HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE)) return {};  // ST-16
  Primitive primitive = primitive_of(candidate, instance);
  IntersectionInvocation invocation;
  static_cast<Invocation&>(invocation) = {frame.lane, frame.arguments, &primitive, candidate.t_current,
                                          frame.record_at(selected.address)};
  invocation.frame = &frame;
  invocation.group = group;
  invocation.candidate = &primitive;
  invocation.opaque = candidate.opaque;
  invocation.wins_ties = candidate.wins_ties;
  run_shader(invocation, group->intersection, nullptr, nullptr);
  return {.commit = invocation.accepted,
          .end_search = invocation.ended,
          .t = invocation.accepted_t,
          .hit_kind = invocation.accepted_kind};
}

/// True when DXR lets the report be looked at (IS-04, IS-12, IS-18).
bool is_reportable(const IntersectionInvocation& self, float t, uint hit_kind) {
  const Lane& lane = *self.frame->lane;
  if (std::isnan(t)) {
    lane.report("IS-18", [] { return std::string("ReportHit with t = NaN; the report is dropped"); });
    return false;
  }
  if (hit_kind > 127) {
    lane.report("IS-12", [&] {
      return "ReportHit with hit kind " + std::to_string(hit_kind) + ", allowed are 0 to 127; the report is dropped";
    });
    return false;
  }
  const bool takes_equal = self.accepted || self.wins_ties;
  return self.frame->arguments->desc.TMin <= t && (takes_equal ? t <= self.t_current : t < self.t_current);
}

/// Any-hit for a reported hit, seeing its t and hit kind; ray and record are the intersection shader's (RS-03).
HitDecision judge_report(IntersectionInvocation& self, float t, uint hit_kind, const void* attributes,
                         const TypeInfo& type) {
  if (self.opaque) return HitDecision::accept;
  Primitive primitive = *self.candidate;
  primitive.hit_kind = hit_kind;
  const ReportedAttributes copy(attributes, type);
  Invocation invocation{self.lane, self.ray, &primitive, t, self.record};
  return run_any_hit(invocation, *self.frame, *self.group, copy.bytes, type);
}

}  // namespace

ReportHitResult report_hit(Invocation& invocation, float t, uint hit_kind, const void* attributes,
                           const TypeInfo& type) {
  auto& self = static_cast<IntersectionInvocation&>(invocation);
  self.frame->lane->check_alive();
  if (self.ended) return VerdictAccess::report(false, true);
  if (!is_reportable(self, t, hit_kind)) return VerdictAccess::report(false, false);
  const HitDecision decision = judge_report(self, t, hit_kind, attributes, type);
  if (decision == HitDecision::ignore) return VerdictAccess::report(false, false);
  self.frame->reported = ReportedAttributes(attributes, type);
  self.t_current = t;
  self.accepted = true;
  self.accepted_t = t;
  self.accepted_kind = hit_kind;
  self.ended = ends_search(*self.frame, decision);
  return VerdictAccess::report(true, self.ended);
}

accel::Verdict decide_candidate(void* user, const accel::Candidate& candidate) noexcept {
  RayFrame& frame = *static_cast<RayFrame*>(user);
  if (frame.failure) return {.end_search = true};
  const ObservedLane observed(*frame.lane);
  try {
    const auto& instance = *reinterpret_cast<const accel::InstanceRecord*>(candidate.instance);
    return candidate.type == accel::HitType::triangle ? decide_triangle(frame, candidate, instance)
                                                      : decide_procedural(frame, candidate, instance);
  } catch (...) {
    frame.failure = std::current_exception();
    return {.end_search = true};
  }
}

}  // namespace rayloom::detail
