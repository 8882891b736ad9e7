#pragma once

// Rays in, hits out: the one door into traversal for everything outside accel.
//
// Every kernel (scalar, AVX2, AVX-512; one ray or many) gives the same bits and visits candidates in the same order
// (guarantees G1 to G3 of docs/architecture.md), so callers choose nothing for correctness.

#include <rayloom/accel/build.h>
#include <rayloom/accel/ray.h>

#include <cstdint>
#include <span>
#include <string_view>

namespace rayloom::accel {

/// A primitive that traversal cannot decide on its own: a non-opaque triangle that is hit inside the current interval,
/// or a procedural primitive whose box may be.
struct Candidate {
  HitType type;             ///< triangle or procedural
  uint32_t instance_index;  ///< 0 when a bottom-level structure is traced directly
  uint32_t geometry_index;
  uint32_t primitive_index;
  float t, u, v;              ///< triangle only
  uint32_t hit_kind;          ///< triangle only: 254 front, 255 back
  bool opaque;                ///< procedural only: resolved from geometry, instance and ray flags (OP rows)
  float t_current;            ///< t of the closest committed hit, the ray's t_max before any
  bool wins_ties;             ///< procedural only: whether a report at exactly t_current counts (G3b: it does not when
                              ///< the committed hit is a procedural primitive of a larger name)
  const std::byte* instance;  ///< InstanceRecord of layout.h, null when a bottom level is traced directly
};

/// What the caller decides. A triangle is committed as it stands; a procedural primitive at `t` with `hit_kind`,
/// which must satisfy t_min <= t <= t_current (t < t_current unless wins_ties); any other t commits nothing.
struct Verdict {
  bool commit = false;
  bool end_search = false;  ///< after the commit, if any
  float t = 0;
  uint32_t hit_kind = 0;
};

using CandidateFunction = Verdict (*)(void* user, const Candidate&) noexcept;

/// One ray to trace. `structure` is a top- or bottom-level block; null misses (TR-03). NaN or infinite origins and
/// directions, a zero direction, NaN limits, t_min < 0 and t_min > t_max all miss (TR-17, TR-18).
struct TraceRequest {
  Ray ray;
  const std::byte* structure = nullptr;
  uint32_t ray_flags = 0;
  uint32_t instance_mask = 0xFF;          ///< low 8 bits (TR-11)
  CandidateFunction candidate = nullptr;  ///< null: non-opaque triangles count as opaque, procedurals never hit
  void* user = nullptr;
};

/// Traverses for the closest hit (the first committed one with accept_first_hit_and_end_search).
Hit trace(AddressSpace addresses, const TraceRequest& request);

/// The same for many rays; requests are independent. hits.size() == requests.size(). Chooses a kernel from the batch.
void trace(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits);

/// The same for rays that share everything but themselves: `shared` without its own ray. Quicker to pass and to look
/// at. hits.size() == rays.size().
void trace(AddressSpace addresses, const TraceRequest& shared, std::span<const Ray> rays, std::span<Hit> hits);

/// Whether each ray hits anything (1 or 0), as with accept_first_hit_and_end_search, which is implied. Quicker than
/// trace(), since a hit need not be computed to be known. results.size() == rays.size().
void occluded(AddressSpace addresses, const TraceRequest& shared, std::span<const Ray> rays,
              std::span<uint8_t> results);

/// Instruction sets with a kernel, fastest last. `name` is what --isa takes.
enum class Isa : uint8_t { scalar, avx2, avx512 };
std::string_view isa_name(Isa isa);
bool isa_supported(Isa isa);
/// The one in use: the fastest supported, unless set_isa() chose another (process wide; throws InputError if
/// unsupported).
Isa current_isa();
void set_isa(Isa isa);

}  // namespace rayloom::accel
