#pragma once

// One ray inside the RT core, as it computes (guarantee G6). It keeps its own stack, runs accel's box and triangle
// tests on the structure's bytes, and compares every step, every outcome and the final hit with the capture. The timing
// model asks it what comes next; only shader verdicts are taken from the capture, for their shaders ran there.

#include <rayloom/accel/traverse-inl.h>
#include <rayloom/hwmodel/capture.h>
#include <rayloom/hwmodel/ray_stack.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rayloom::hwmodel {

/// The replay came to something else than the capture says. Names warp, lane, ray, event and what differed.
class ReplayMismatch : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a ray needs next: bytes at an address, a shader's verdict, or nothing more.
struct RayStep {
  enum class Kind : uint8_t { node, triangle_leaf, procedural_leaf, instance, candidate, done };
  Kind kind = Kind::done;
  RequestClass request_class{};
  uint64_t address = 0;
  uint32_t bytes = 0;
  uint32_t culled_pops = 0;  ///< stack entries beyond the closest hit that went before it
};

/// The unit that fetched bytes go to, and how much it has to do.
struct RayWork {
  enum class Unit : uint8_t { none, box, triangle, transform };
  Unit unit = Unit::none;
  uint32_t tests = 0;
};

class RayMachine {
 public:
  RayMachine() = default;
  RayMachine(const RayMachine&) = delete;
  RayMachine& operator=(const RayMachine&) = delete;

  void start(const Capture& capture, uint64_t warp, uint32_t ray);

  /// Takes the next step off the stack. At `done` all of the capture's events must have happened and the hits agree.
  RayStep next();
  /// After the bytes of a step are there: what to do with them.
  RayWork work() const;
  /// Does it.
  void complete();

  /// At a candidate step: its index into WarpCapture::candidates; whether any shader ran; and going on after it.
  uint32_t candidate_index() const { return asked_[next_asked_]; }
  bool candidate_runs_shader() const;
  void decide() { ++next_asked_; }

 private:
  template <class Sink>
  friend class RayEventVisitor;
  using Level = accel::scalar::Level;

  static accel::Verdict captured_verdict(void* machine, const accel::Candidate& candidate) noexcept;
  void event(const RayEvent& own);
  void candidate(const accel::Candidate& own, const accel::Verdict& verdict);
  void check_structure() const;
  void check_finished() const;
  [[noreturn]] void mismatch(const std::string& what) const;

  void enter_structure();
  void push_start(const std::byte* block, uint32_t start, const accel::Ray& ray, float pad_scale);
  RayStep step_to(uint32_t ref);
  const accel::InstanceRecord& instance_record() const;
  bool enters_instance() const;
  void test_node();
  void test_leaf();
  void enter_instance();
  void leave_instance();
  const std::byte* bytes_at(uint64_t address) const { return capture_->header.addresses.host(address); }

  const Capture* capture_ = nullptr;
  const WarpCapture* warp_ = nullptr;
  const RayCapture* ray_ = nullptr;
  uint64_t warp_index_ = 0;
  uint32_t ray_index_ = 0;
  uint32_t next_event_ = 0;      // of the ray's own
  uint32_t next_candidate_ = 0;  // likewise

  accel::TraceRequest request_;
  std::optional<accel::Search> search_;
  // The level in use is the last one entered: the bottom one inside an instance, else the only one.
  std::optional<Level> top_, bottom_;
  std::optional<accel::InstanceRules> rules_;
  RayStack top_stack_, bottom_stack_;
  const accel::InstanceRecord* instance_ = nullptr;
  bool ended_ = false;
  RayStep step_;
  std::vector<uint32_t> asked_;  // candidates of the leaf just tested
  size_t next_asked_ = 0;
};

}  // namespace rayloom::hwmodel
