#include <rayloom/runtime/ray_batch.h>

#include <algorithm>

namespace rayloom::detail {
namespace {

/// A null structure and one that cannot be traced both miss (TR-03, TL-11, TL-12).
const TopLevel* find_scene(const DispatchContext& dispatch, uint64_t address) {
  if (address == 0) return nullptr;
  const TopLevel& scene = dispatch.structures.find(address);
  return scene.block ? &scene : nullptr;
}

/// Whether shaders decide which candidates of these rays count.
bool asks(const DispatchContext& dispatch, const TopLevel* scene, uint traversal_flags) {
  if (!dispatch.pipeline.decides_candidates) return false;
  // A tracer of its own is told what the program is; accel only what can come up.
  return dispatch.tracer || (scene && scene->asks(traversal_flags));
}

TraceCall call_of(const accel::TraceRequest& request, const RayFrame& frame) {
  return {frame.lane->number, frame.scene ? frame.arguments->structure : 0, frame.payload_type.bytes, request, {}};
}
TraceCall call_of(const accel::TraceRequest& request) {
  return call_of(request, *static_cast<const RayFrame*>(request.user));
}

accel::TraceRequest request_of(RayFrame& frame, const accel::TraceRequest& shared) {
  accel::TraceRequest request = shared;
  std::memcpy(&request.ray, &frame.arguments->desc, sizeof(request.ray));
  request.user = &frame;
  return request;
}

}  // namespace

RayBatch::RayBatch(const DispatchContext& dispatch, uint32_t capacity) : dispatch_(dispatch), capacity_(capacity) {
  groups_.reserve(most_groups);
  current_ = &groups_.emplace_back();
  define(*current_, {});
}

void RayBatch::clear() {
  size_ = 0;
  apart_count_ = 0;
  for (Group& group : groups_) group.count = 0;
}

RayBatch::Group& RayBatch::change_group(const TraceRayArguments& call) {
  const auto found =
      std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) { return group.takes(call); });
  current_ = found != groups_.end() ? &*found : &unused_group();
  if (!current_->takes(call)) define(*current_, call);
  return *current_;
}

/// One without rays; where there is none, that for rays apart.
RayBatch::Group& RayBatch::unused_group() {
  if (groups_.size() < most_groups) return groups_.emplace_back();
  const auto found = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return group.count == 0; });
  return found != groups_.end() ? *found : overflow_;
}

void RayBatch::define(Group& group, const TraceRayArguments& call) {
  constexpr uint occlusion = RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH | RAY_FLAG_SKIP_CLOSEST_HIT_SHADER;
  const uint traversal_flags = call.flags | dispatch_.pipeline.config.Flags;
  group.address = call.structure;
  group.flags = call.flags;
  group.mask = call.instance_mask & 0xFFu;
  group.scene = find_scene(dispatch_, call.structure);
  const bool asks_shaders = asks(dispatch_, group.scene, traversal_flags);
  group.apart = dispatch_.tracer || asks_shaders || &group == &overflow_;
  group.only_occlusion = (call.flags & occlusion) == occlusion;
  group.shared = {.ray = {},
                  .structure = group.scene ? group.scene->block : nullptr,
                  .ray_flags = traversal_flags,
                  .instance_mask = group.mask,
                  .candidate = asks_shaders ? decide_candidate : nullptr};
  if (group.apart) return;
  group.rays.resize(capacity_);
  group.hits.resize(capacity_);
}

const accel::Hit* RayBatch::add_apart(RayFrame& frame, const Group& group) {
  if (requests_.empty()) {
    requests_.resize(capacity_);
    hits_.resize(capacity_);
  }
  const size_t slot = apart_count_++;
  requests_[slot] = request_of(frame, group.shared);
  return &hits_[slot];
}

void RayBatch::trace(WarpTracer* tracer) {
  const size_t apart = apart_count_;
  if (tracer) {
    trace_by_tracer(*tracer, apart);
  } else {
    for (Group& group : groups_)
      if (group.count != 0) trace_group(group);
    if (apart != 0) accel::trace(dispatch_.memory.addresses(), {requests_.data(), apart}, {hits_.data(), apart});
  }
  clear();
}

void RayBatch::trace_group(Group& group) {
  const uint32_t count = group.count;
  const std::span<const accel::Ray> rays(group.rays.data(), count);
  if (!group.only_occlusion)
    return accel::trace(dispatch_.memory.addresses(), group.shared, rays, {group.hits.data(), count});
  occluded_.resize(capacity_);
  accel::occluded(dispatch_.memory.addresses(), group.shared, rays, {occluded_.data(), count});
  for (uint32_t i = 0; i < count; ++i)
    group.hits[i].type = occluded_[i] ? accel::HitType::triangle : accel::HitType::none;
}

void RayBatch::trace_by_tracer(WarpTracer& tracer, size_t count) {
  calls_.clear();
  for (size_t i = 0; i < count; ++i) calls_.push_back(call_of(requests_[i]));
  tracer.trace(calls_);
  for (size_t i = 0; i < count; ++i) hits_[i] = calls_[i].hit;
}

accel::Hit RayBatch::trace_now(RayFrame& frame, WarpTracer* tracer) {
  const Group& group = group_of(*frame.arguments);
  frame.scene = group.scene;
  const accel::TraceRequest request = request_of(frame, group.shared);
  if (!tracer) return accel::trace(dispatch_.memory.addresses(), request);
  TraceCall call = call_of(request, frame);
  tracer->trace({&call, 1});
  return call.hit;
}

}  // namespace rayloom::detail
