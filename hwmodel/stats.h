#pragma once

// Small pieces that statistics are made of. A Stats struct is plain data with one field list,
//   template <class F> static void fields(F&& f) { f("rays", &Stats::rays); ... }
// which every printer, sum and comparison goes through, so that no list has to be kept in step with another.

#include <rayloom/hwmodel/capture.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace rayloom::hwmodel {

/// Adds every field of `from` to `to`.
template <class Stats>
void accumulate(Stats& to, const Stats& from) {
  Stats::fields([&](const char*, auto member) { to.*member += from.*member; });
}

/// A counter for each request class.
struct ClassCounts {
  std::array<uint64_t, request_class_count> values{};

  uint64_t& operator[](RequestClass c) { return values[static_cast<size_t>(c)]; }
  uint64_t operator[](RequestClass c) const { return values[static_cast<size_t>(c)]; }
  uint64_t total() const {
    uint64_t sum = 0;
    for (const uint64_t value : values) sum += value;
    return sum;
  }
  ClassCounts& operator+=(const ClassCounts& other) {
    for (size_t i = 0; i < values.size(); ++i) values[i] += other.values[i];
    return *this;
  }
  friend bool operator==(const ClassCounts&, const ClassCounts&) = default;
};

/// Clocks by cause. State is an enum class whose last enumerator is `count`; its names come from state_name(State).
template <class State>
struct StateTable {
  static constexpr size_t size = static_cast<size_t>(State::count);
  std::array<uint64_t, size> cycles{};

  uint64_t& operator[](State s) { return cycles[static_cast<size_t>(s)]; }
  uint64_t operator[](State s) const { return cycles[static_cast<size_t>(s)]; }
  uint64_t total() const {
    uint64_t sum = 0;
    for (const uint64_t value : cycles) sum += value;
    return sum;
  }
  StateTable& operator+=(const StateTable& other) {
    for (size_t i = 0; i < size; ++i) cycles[i] += other.cycles[i];
    return *this;
  }
  friend bool operator==(const StateTable&, const StateTable&) = default;
};

}  // namespace rayloom::hwmodel
