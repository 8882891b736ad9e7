#pragma once

// What any-hit and intersection shaders decide. In HLSL IgnoreHit(), AcceptHitAndEndSearch() and a ReportHit() that
// ends the search never return; here they are *returned*, so destructors run and no catch(...) can swallow them. This
// is the one deliberate difference from DXR (docs/dxr-differences.md; rows AH-03, AH-04, AH-07, IS-07, IS-08, ERR-10).

#include <rayloom/runtime/tracer.h>

#include <cstdint>

namespace rayloom {

template <ShaderStage>
class StageContext;

namespace detail {
enum class HitDecision : uint8_t { accept, ignore, accept_and_end_search };
struct VerdictAccess;
}  // namespace detail

/// An any-hit shader's answer; made by ctx.AcceptHit(), ctx.IgnoreHit() and ctx.AcceptHitAndEndSearch() alone.
class [[nodiscard]] AnyHitVerdict {
 public:
  AnyHitVerdict() = delete;

 private:
  friend class StageContext<ShaderStage::any_hit>;
  friend struct detail::VerdictAccess;
  explicit AnyHitVerdict(detail::HitDecision decision) : decision_(decision) {}
  detail::HitDecision decision_;
};

/// What became of one ReportHit. True when the hit was accepted, as in HLSL. When search_ended() the shader must return
/// it; should it go on all the same, nothing it reports is heard any more and the search ends when it returns.
class [[nodiscard]] ReportHitResult {
 public:
  ReportHitResult() = delete;
  explicit operator bool() const { return accepted_; }
  bool accepted() const { return accepted_; }
  bool search_ended() const { return ended_; }

 private:
  friend class StageContext<ShaderStage::intersection>;
  friend struct detail::VerdictAccess;
  ReportHitResult(bool accepted, bool ended) : accepted_(accepted), ended_(ended) {}
  bool accepted_, ended_;
};

/// An intersection shader's answer: the result of its last ReportHit, or ctx.EndIntersection() when it has none to
/// give.
class [[nodiscard]] IntersectionVerdict {
 public:
  IntersectionVerdict() = delete;
  IntersectionVerdict(const ReportHitResult&) {}

 private:
  friend class StageContext<ShaderStage::intersection>;
  struct Private {};
  explicit IntersectionVerdict(Private) {}
};

namespace detail {
struct VerdictAccess {
  static HitDecision decision(const AnyHitVerdict& verdict) { return verdict.decision_; }
  static ReportHitResult report(bool accepted, bool ended) { return {accepted, ended}; }
};
}  // namespace detail

}  // namespace rayloom
