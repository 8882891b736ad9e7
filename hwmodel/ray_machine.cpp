#include <rayloom/hwmodel/ray_events.h>
#include <rayloom/hwmodel/ray_machine.h>

#include <algorithm>
#include <cstring>

namespace rayloom::hwmodel {

using accel::InstanceRecord;
using accel::Node8;
using accel::Offer;
using accel::ProceduralLeaf8;
using accel::StructureHeader;
using accel::StructureKind;
using accel::TriangleLeaf;

void RayMachine::start(const Capture& capture, uint64_t warp, uint32_t ray) {
  capture_ = &capture;
  warp_index_ = warp;
  warp_ = &capture.warps[warp];
  ray_index_ = ray;
  ray_ = &warp_->rays[ray];
  next_event_ = next_candidate_ = 0;
  check_structure();
  request_ = {ray_->ray,
              ray_->structure_address ? bytes_at(ray_->structure_address) : nullptr,
              ray_->ray_flags,
              ray_->instance_mask,
              ray_->asks_candidates ? captured_verdict : nullptr,
              this};
  search_.emplace(request_);
  top_.reset();
  bottom_.reset();
  rules_.reset();
  top_stack_.clear();
  bottom_stack_.clear();
  instance_ = nullptr;
  ended_ = false;
  asked_.clear();
  next_asked_ = 0;
  enter_structure();
}

void RayMachine::check_structure() const {
  const auto& ranges = capture_->header.structures;
  const uint64_t address = ray_->structure_address;
  const bool known = address == 0 || std::any_of(ranges.begin(), ranges.end(),
                                                 [&](const StructureRange& range) { return range.address == address; });
  if (!known) mismatch("the ray's structure address is not that of a captured structure");
}

void RayMachine::enter_structure() {
  if (!request_.structure) return;
  const StructureHeader& header = accel::header_of(request_.structure);
  if (header.root == accel::no_index) return;
  if (header.kind == StructureKind::instances)
    return push_start(request_.structure, header.root, request_.ray, header.pad_scale);
  rules_.emplace(0, 0, request_.ray_flags, nullptr);
  if (accel::scalar::wants(request_, header)) push_start(request_.structure, header.root, request_.ray, 1);
}

void RayMachine::push_start(const std::byte* block, uint32_t start, const accel::Ray& ray, float pad_scale) {
  const bool bottom = accel::header_of(block).kind != StructureKind::instances;
  auto& level = bottom ? bottom_ : top_;
  level.emplace(block, ray, pad_scale, *search_);
  if (!level->ray.valid) return level.reset();
  (bottom ? bottom_stack_ : top_stack_).push(start, level->t_near);
}

RayStep RayMachine::next() {
  step_ = {};
  if (next_asked_ < asked_.size()) {
    step_.kind = RayStep::Kind::candidate;
    return step_;
  }
  for (;;) {
    if (instance_ && (ended_ || bottom_stack_.empty())) leave_instance();
    RayStack& stack = bottom_ ? bottom_stack_ : top_stack_;
    if (ended_ || stack.empty()) {
      check_finished();
      return step_;
    }
    const auto [ref, near] = stack.pop();
    if (near <= (bottom_ ? bottom_ : top_)->t_far) return step_to(ref);
    ++step_.culled_pops;
  }
}

RayStep RayMachine::step_to(uint32_t ref) {
  const Level& level = *(bottom_ ? bottom_ : top_);
  const std::byte* const where = level.block + accel::node_ref::offset(ref);
  step_.address = static_cast<uint64_t>(where - bytes_at(0));
  const auto set = [&](RayStep::Kind kind, RequestClass request_class, size_t bytes) {
    step_.kind = kind;
    step_.request_class = request_class;
    step_.bytes = static_cast<uint32_t>(bytes);
  };
  if (!accel::node_ref::is_leaf(ref)) {
    set(RayStep::Kind::node, bottom_ ? RequestClass::bottom_node : RequestClass::top_node, sizeof(Node8));
  } else if (!bottom_) {
    set(RayStep::Kind::instance, RequestClass::instance, sizeof(InstanceRecord));
  } else if (accel::header_of(level.block).kind == StructureKind::triangles) {
    set(RayStep::Kind::triangle_leaf, RequestClass::leaf, reinterpret_cast<const TriangleLeaf*>(where)->bytes());
  } else {
    set(RayStep::Kind::procedural_leaf, RequestClass::leaf, sizeof(ProceduralLeaf8));
  }
  return step_;
}

namespace {

uint32_t used_lanes(const uint32_t (&primitive)[8]) {
  return static_cast<uint32_t>(8 - std::count(primitive, primitive + 8, accel::no_index));
}

}  // namespace

RayWork RayMachine::work() const {
  const std::byte* const where = bytes_at(step_.address);
  switch (step_.kind) {
    case RayStep::Kind::node:
      return {RayWork::Unit::box, 8};
    case RayStep::Kind::triangle_leaf:
      return {RayWork::Unit::triangle, reinterpret_cast<const TriangleLeaf*>(where)->count};
    case RayStep::Kind::procedural_leaf:
      return {RayWork::Unit::box, used_lanes(reinterpret_cast<const ProceduralLeaf8*>(where)->primitive)};
    case RayStep::Kind::instance:
      return {enters_instance() ? RayWork::Unit::transform : RayWork::Unit::none, 0};
    default:
      return {};
  }
}

void RayMachine::complete() {
  switch (step_.kind) {
    case RayStep::Kind::node:
      return test_node();
    case RayStep::Kind::triangle_leaf:
    case RayStep::Kind::procedural_leaf:
      return test_leaf();
    case RayStep::Kind::instance:
      if (enters_instance()) enter_instance();
      return;
    default:
      return;
  }
}

void RayMachine::test_node() {
  const Level& level = *(bottom_ ? bottom_ : top_);
  const auto* node = reinterpret_cast<const Node8*>(bytes_at(step_.address));
  const auto hits = accel::scalar::test_node(accel::scalar::BoxLanes(level.ray), *node, level.t_near, level.t_far);
  RayEventVisitor(capture_->header.addresses, *this).on_node(node, hits.mask, hits.near);
  const bool any_hit = request_.ray_flags & accel::ray_flag::accept_first_hit_and_end_search;
  (bottom_ ? bottom_stack_ : top_stack_).push_children(*node, hits.mask, hits.near, !any_hit);
}

void RayMachine::test_leaf() {
  asked_.clear();
  next_asked_ = 0;
  RayEventVisitor visitor(capture_->header.addresses, *this);
  const std::byte* const where = bytes_at(step_.address);
  const auto visit = [&](const auto& leaves) { return leaves.visit(*bottom_, where, *search_, visitor); };
  const Offer offer = step_.kind == RayStep::Kind::triangle_leaf ? visit(accel::scalar::TriangleLeaves{*rules_})
                                                                 : visit(accel::scalar::ProceduralLeaves{*rules_});
  if (offer == Offer::committed) bottom_->shorten(*search_);
  ended_ = offer == Offer::ended;
}

const InstanceRecord& RayMachine::instance_record() const {
  return *reinterpret_cast<const InstanceRecord*>(bytes_at(step_.address));
}

bool RayMachine::enters_instance() const {
  const InstanceRecord& record = instance_record();
  return (record.id_and_mask >> 24 & request_.instance_mask) != 0 &&
         accel::scalar::wants(request_, accel::header_of(bytes_at(record.bottom_level_address)));
}

void RayMachine::enter_instance() {
  instance_ = &instance_record();
  const accel::Ray ray = accel::object_ray(*instance_, request_.ray);
  rules_.emplace(instance_->instance_index, instance_->contribution_and_flags >> 24, request_.ray_flags,
                 reinterpret_cast<const std::byte*>(instance_));
  RayEventVisitor(capture_->header.addresses, *this).on_enter_instance(instance_, ray);
  const std::byte* const block = bytes_at(instance_->bottom_level_address);
  push_start(block, accel::scalar::entry_of(*instance_, accel::header_of(block)), ray, 1);
}

void RayMachine::leave_instance() {
  RayEventVisitor(capture_->header.addresses, *this).on_leave_instance(instance_);
  instance_ = nullptr;
  bottom_.reset();
  bottom_stack_.clear();
  top_->shorten(*search_);
}

bool RayMachine::candidate_runs_shader() const { return warp_->candidates[candidate_index()].segment_count > 0; }

// What the capture's shader answered to the candidate that comes next. Whether that candidate is this one is checked by
// candidate(), which may throw as this must not.
accel::Verdict RayMachine::captured_verdict(void* machine, const accel::Candidate&) noexcept {
  const auto& self = *static_cast<const RayMachine*>(machine);
  const size_t index = size_t{self.ray_->candidate_begin} + self.next_candidate_;
  return index < self.warp_->candidates.size() ? self.warp_->candidates[index].verdict : accel::Verdict{};
}

void RayMachine::candidate(const accel::Candidate& own, const accel::Verdict& verdict) {
  const uint32_t index = ray_->candidate_begin + next_candidate_++;
  event({0, index, RayEventKind::candidate, 0, digest_of(verdict)});
  if (index >= warp_->candidates.size()) mismatch("the candidate is not in the capture");
  const CandidateCapture& captured = warp_->candidates[index];
  const bool same = captured.type == own.type && captured.opaque == own.opaque &&
                    captured.instance_index == own.instance_index && captured.geometry_index == own.geometry_index &&
                    captured.primitive_index == own.primitive_index && captured.t == own.t &&
                    captured.t_current == own.t_current;
  if (!same) mismatch("the candidate offered to the shader differs");
  asked_.push_back(index);
}

namespace {

std::string describe(const RayEvent& event) {
  std::string text = std::string(ray_event_kind_name(event.kind)) + " at " + std::to_string(event.address);
  text += ", mask " + std::to_string(event.mask) + ", payload " + std::to_string(event.payload);
  return text + ", digest " + std::to_string(event.digest);
}

}  // namespace

void RayMachine::event(const RayEvent& own) {
  if (next_event_ >= ray_->event_count) mismatch("the replay has one more event: " + describe(own));
  const RayEvent& captured = warp_->events[ray_->event_begin + next_event_];
  if (!(captured == own)) mismatch("the capture has " + describe(captured) + "; the replay has " + describe(own));
  ++next_event_;
}

void RayMachine::check_finished() const {
  if (next_event_ != ray_->event_count)
    mismatch("the ray has ended; the capture goes on with " + describe(warp_->events[ray_->event_begin + next_event_]));
  const accel::Hit &own = search_->hit(), &captured = ray_->hit;
  const auto same_bits = [](float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  const bool same = own.type == captured.type && own.instance_index == captured.instance_index &&
                    own.geometry_index == captured.geometry_index && own.primitive_index == captured.primitive_index &&
                    own.hit_kind == captured.hit_kind && same_bits(own.t, captured.t) && same_bits(own.u, captured.u) &&
                    same_bits(own.v, captured.v);
  if (!same)
    mismatch("the hit differs: the capture has t " + std::to_string(captured.t) + ", the replay t " +
             std::to_string(own.t));
}

void RayMachine::mismatch(const std::string& what) const {
  throw ReplayMismatch("replay differs from capture: warp " + std::to_string(warp_index_) + ", lane " +
                       std::to_string(ray_->lane) + ", ray " + std::to_string(ray_index_) + ", event " +
                       std::to_string(next_event_) + ": " + what);
}

}  // namespace rayloom::hwmodel
