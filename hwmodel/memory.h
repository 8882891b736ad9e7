#pragma once

// What travels between the levels of the memory system.

#include <rayloom/hwmodel/event_queue.h>
#include <rayloom/hwmodel/sector_cache.h>
#include <rayloom/hwmodel/stats.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

inline constexpr uint32_t sector_bytes = 32;

enum class ServedBy : uint16_t { l1, l2, dram };

/// Some sectors of one line.
struct LineRequest {
  uint64_t line = 0;  ///< address / line bytes
  SectorMask sectors = 0;
};

/// Appends the lines that [address, address + bytes) touches, joining those already in `lines`.
void add_lines(std::vector<LineRequest>& lines, uint64_t address, uint64_t bytes, uint32_t line_bytes);

inline uint32_t sector_count(SectorMask sectors) { return static_cast<uint32_t>(__builtin_popcount(sectors)); }

/// A request to the level below, and how it is carried by an event (fields a and b).
struct MemoryMessage {
  LineRequest request;
  RequestClass request_class{};
  bool store = false;

  uint32_t packed() const {
    return request.sectors | static_cast<uint32_t>(request_class) << 16 | static_cast<uint32_t>(store) << 24;
  }
  static MemoryMessage from(const Event& event) {
    return {{event.a, event.b & 0xFFFF}, static_cast<RequestClass>(event.b >> 16 & 0xFF), (event.b >> 24 & 1) != 0};
  }
};

/// A resource that serves one thing at a time, in order of asking: idle clocks are never visited.
class Port {
 public:
  /// Takes the port for `cycles` at `ready` or as soon after as it is free; returns when.
  Cycle reserve(Cycle ready, Cycle cycles) {
    const Cycle start = std::max(ready, next_free_);
    next_free_ = start + cycles;
    busy_ += cycles;
    return start;
  }
  Cycle next_free() const { return next_free_; }
  Cycle busy() const { return busy_; }

 private:
  Cycle next_free_ = 0, busy_ = 0;
};

/// What every cache level counts, in sectors unless said otherwise.
struct CacheStats {
  ClassCounts accesses;           ///< sectors asked for by loads
  ClassCounts hits;               ///< of these: present
  ClassCounts half_misses;        ///< not present, but already on their way
  ClassCounts misses;             ///< asked of the level below
  ClassCounts stores;             ///< sectors written
  ClassCounts line_accesses;      ///< lines looked up by loads, retries not counted
  uint64_t mshr_full = 0;         ///< line requests that found no entry or no place in one, and waited
  uint64_t mshr_wait_cycles = 0;  ///< clocks these waited, summed
  uint64_t mshr_peak = 0;         ///< most entries in use at once

  template <class F>
  static void fields(F&& f) {
    f("accesses", &CacheStats::accesses);
    f("hits", &CacheStats::hits);
    f("half_misses", &CacheStats::half_misses);
    f("misses", &CacheStats::misses);
    f("stores", &CacheStats::stores);
    f("line_accesses", &CacheStats::line_accesses);
    f("mshr_full", &CacheStats::mshr_full);
    f("mshr_wait_cycles", &CacheStats::mshr_wait_cycles);
  }
};

}  // namespace rayloom::hwmodel
