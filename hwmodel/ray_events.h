#pragma once

// Turns what a traversal visits into ray events. The recorder writes them down, the replay compares them with what was
// written: both use this one visitor, so every field of every event is checked.

#include <rayloom/accel/visitor.h>
#include <rayloom/hwmodel/capture.h>

#include <bit>
#include <cstddef>
#include <cstdint>

namespace rayloom::hwmodel {

/// Sixteen bits of a digest of floats and words.
class Digest {
 public:
  Digest& add(uint32_t word) {
    state_ = (std::rotl(state_, 5) ^ word) * 0x9E3779B1u;
    return *this;
  }
  Digest& add(float value) { return add(std::bit_cast<uint32_t>(value)); }
  uint16_t value() const { return static_cast<uint16_t>(state_ ^ state_ >> 16); }

 private:
  uint32_t state_ = 0;
};

inline uint16_t digest_of(const accel::Verdict& verdict) {
  return Digest()
      .add(static_cast<uint32_t>(verdict.commit) | static_cast<uint32_t>(verdict.end_search) << 1)
      .add(verdict.t)
      .add(verdict.hit_kind)
      .value();
}

/// Sink: void event(const RayEvent&); void candidate(const accel::Candidate&, const accel::Verdict&).
template <class Sink>
class RayEventVisitor : public accel::Visitor {
 public:
  RayEventVisitor(accel::AddressSpace addresses, Sink& sink) : addresses_(addresses), sink_(sink) {}

  void on_node(const accel::Node8* node, uint32_t hit_mask, const float (&near)[8]) {
    Digest digest;
    for (uint32_t left = hit_mask; left != 0; left &= left - 1) digest.add(near[std::countr_zero(left)]);
    emit(RayEventKind::node, node, hit_mask, digest);
  }
  void on_triangle_leaf(const accel::TriangleLeaf* leaf, uint32_t possible_mask, uint32_t hit_mask) {
    emit(RayEventKind::triangle_leaf, leaf, hit_mask, Digest().add(possible_mask));
  }
  void on_procedural_leaf(const accel::ProceduralLeaf8* leaf, uint32_t box_mask, uint32_t offered_mask) {
    emit(RayEventKind::procedural_leaf, leaf, box_mask, Digest().add(offered_mask));
  }
  void on_enter_instance(const accel::InstanceRecord* instance, const accel::Ray& object_ray) {
    Digest digest;
    for (const float value : object_ray.origin) digest.add(value);
    for (const float value : object_ray.direction) digest.add(value);
    emit(RayEventKind::enter_instance, instance, 1, digest);
  }
  void on_leave_instance(const accel::InstanceRecord* instance) {
    emit(RayEventKind::leave_instance, instance, 0, Digest());
  }
  void on_candidate(const accel::Candidate& candidate, const accel::Verdict& verdict) {
    sink_.candidate(candidate, verdict);
  }

 private:
  void emit(RayEventKind kind, const void* where, uint32_t mask, const Digest& digest) {
    const auto address = static_cast<uint64_t>(static_cast<const std::byte*>(where) - addresses_.host(0));
    sink_.event({address, 0, kind, static_cast<uint8_t>(mask), digest.value()});
  }

  accel::AddressSpace addresses_;
  Sink& sink_;
};

}  // namespace rayloom::hwmodel
