#include <rayloom/runtime/ray_frame.h>
#include <rayloom/runtime/run_shader.h>
#include <rayloom/runtime/warp.h>

namespace rayloom::detail {
namespace {

/// One level deeper while closest-hit or miss runs (RC-01).
class DepthScope {
 public:
  explicit DepthScope(Lane& lane) : lane_(lane) { ++lane_.trace_depth; }
  ~DepthScope() { --lane_.trace_depth; }
  DepthScope(const DepthScope&) = delete;
  DepthScope& operator=(const DepthScope&) = delete;

 private:
  Lane& lane_;
};

[[noreturn, gnu::cold, gnu::noinline]] void exceed_depth(Lane& lane) {
  lane.remove_device("RC-01: TraceRay at recursion depth " + std::to_string(lane.trace_depth) +
                     ", the pipeline declares MaxTraceRecursionDepth " +
                     std::to_string(lane.dispatch().pipeline.config.MaxTraceRecursionDepth));
}

void check_may_trace(Lane& lane) {
  lane.check_alive();
  if (lane.trace_depth >= lane.dispatch().pipeline.config.MaxTraceRecursionDepth) [[unlikely]]
    exceed_depth(lane);
  lane.check_host_stack(0);
}

void validate_structure(const Lane& lane, uint64_t address) {
  if (address == 0) return;
  const TopLevel& scene = lane.dispatch().structures.find(address);
  if (!scene.block) lane.report(scene.row, [&] { return scene.problem; });
}

[[gnu::cold, gnu::noinline]] void validate_call(const Lane& lane, const TraceRayArguments& arguments,
                                                const TypeInfo& payload_type) {
  const Pipeline& pipeline = lane.dispatch().pipeline;
  validate_ray(lane, arguments, pipeline.config.Flags);
  if (payload_type.bytes > pipeline.shader_config.MaxPayloadSizeInBytes)
    lane.report("SO-15", [&] {
      return "TraceRay with a payload of " + std::to_string(payload_type.bytes) + " bytes, MaxPayloadSizeInBytes is " +
             std::to_string(pipeline.shader_config.MaxPayloadSizeInBytes);
    });
  validate_structure(lane, arguments.structure);
}

BuiltInTriangleIntersectionAttributes barycentrics(const accel::Hit& hit) { return {float2(hit.u, hit.v)}; }

[[gnu::cold, gnu::noinline]] void report_attributes(const RayFrame& frame, uint32_t shader) {
  const std::string& name = frame.lane->dispatch().pipeline.shaders[shader].name;
  frame.lane->report("IS-14", [&] { return "closest-hit shader '" + name + "' takes other attributes"; });
}

/// STG-12, IS-14: the shader must take the attributes the hit has.
bool takes_attributes(const RayFrame& frame, uint32_t shader) {
  const bool triangle = frame.hit->type == accel::HitType::triangle;
  const TypeInfo& given = triangle ? type_info_of<BuiltInTriangleIntersectionAttributes>() : frame.reported.type;
  if (frame.lane->dispatch().pipeline.code[shader].attributes == given) [[likely]]
    return true;
  report_attributes(frame, shader);
  return false;
}

[[gnu::cold, gnu::noinline]] void report_group(const RayFrame& frame, const HitGroup& group) {
  frame.lane->report("ST-20", [&] { return "hit group '" + group.name + "' does not fit the primitive that was hit"; });
}

/// ST-20: the group's type must be the primitive's.
bool fits_group(const RayFrame& frame, const HitGroup& group) {
  const bool triangle = frame.hit->type == accel::HitType::triangle;
  if (triangle == (group.type == HIT_GROUP_TYPE_TRIANGLES)) [[likely]]
    return true;
  report_group(frame, group);
  return false;
}

void run_closest_hit(RayFrame& frame) {
  const accel::Hit& hit = *frame.hit;
  const accel::InstanceRecord& instance = *frame.scene->instances[hit.instance_index];
  const SelectedRecord selected = frame.hit_record(instance, hit.geometry_index);
  if (!selected.target) return;
  const HitGroup& group = frame.lane->dispatch().pipeline.hit_groups[selected.target->index];
  const uint32_t shader = group.closest_hit;
  if (!fits_group(frame, group) || shader == no_shader || !takes_payload(frame, shader) ||
      !takes_attributes(frame, shader))
    return;

  const Primitive primitive{&instance, hit.instance_index, hit.geometry_index, hit.primitive_index, hit.hit_kind};
  const BuiltInTriangleIntersectionAttributes triangle = barycentrics(hit);
  const void* const attributes =
      hit.type == accel::HitType::triangle ? static_cast<const void*>(&triangle) : frame.reported.bytes;
  Invocation invocation{frame.lane, frame.arguments, &primitive, hit.t, frame.record_at(selected.address)};
  const DepthScope depth(*frame.lane);
  run_shader(invocation, shader, frame.payload, attributes);
}

void run_miss(RayFrame& frame) {
  const DispatchContext& dispatch = frame.lane->dispatch();
  const SelectedRecord selected = select_record(*frame.lane, dispatch.miss, frame.arguments->miss_index & 0xFFFFu);
  if (!selected.target || !takes_payload(frame, selected.target->index)) return;
  Invocation invocation{
      frame.lane, frame.arguments, nullptr, frame.arguments->desc.TMax, {&dispatch.miss, selected.address}};
  const DepthScope depth(*frame.lane);
  run_shader(invocation, selected.target->index, frame.payload, nullptr);
}

/// What runs after the search: closest hit, miss, or nothing (TR-04).
void shade(RayFrame& frame) {
  if (!*frame.hit) return run_miss(frame);
  ++frame.lane->counts->hits;
  if (!(frame.arguments->flags & RAY_FLAG_SKIP_CLOSEST_HIT_SHADER)) run_closest_hit(frame);
}

}  // namespace

void report_payload(const RayFrame& frame, uint32_t shader) {
  const std::string& name = frame.lane->dispatch().pipeline.shaders[shader].name;
  frame.lane->report("STG-13", [&] { return "shader '" + name + "' takes another payload than TraceRay gave"; });
}

void trace_ray(Invocation& caller, TraceRayArguments& arguments, void* payload, const TypeInfo& payload_type) {
  Lane& lane = lane_of(caller);
  check_may_trace(lane);
  if (lane.dispatch().validates) [[unlikely]]
    validate_call(lane, arguments, payload_type);
  arguments.flags &= defined_ray_flags;
  RayFrame frame(lane, arguments, payload, payload_type);
  ++lane.counts->rays;
  lane.warp->trace(lane, frame);
  if (frame.failure) [[unlikely]]
    std::rethrow_exception(frame.failure);
  shade(frame);
}

}  // namespace rayloom::detail
