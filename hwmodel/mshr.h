#pragma once

// Miss status holding registers: lines on their way, and who waits for which of their sectors. A fixed number of
// entries with a fixed number of waiters each; a full table says so and the caller must wait (back-pressure).

#include <rayloom/hwmodel/sector_cache.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

template <class Waiter>
class MshrTable {
 public:
  struct Waiting {
    Waiter who;
    SectorMask needs;
  };
  struct Entry {
    uint64_t line;
    SectorMask pending;  ///< requested from below and not yet back
    std::vector<Waiting> waiting;
  };
  enum class Outcome { allocated, merged, full };
  struct Result {
    Outcome outcome;
    SectorMask request;  ///< sectors to ask the level below for; 0 when all are on their way
  };

  MshrTable(uint32_t entries, uint32_t waiters) : max_waiters_(waiters) {
    entries_.reserve(entries);
    capacity_ = entries;
  }

  Result add(uint64_t line, SectorMask needs, const Waiter& who) {
    Entry* entry = find(line);
    if (entry ? entry->waiting.size() >= max_waiters_ : entries_.size() >= capacity_) return {Outcome::full, 0};
    const bool fresh = !entry;
    if (fresh) entry = &entries_.emplace_back(Entry{line, 0, {}});
    const SectorMask request = needs & ~entry->pending;
    entry->pending |= request;
    entry->waiting.push_back({who, needs});
    return {fresh ? Outcome::allocated : Outcome::merged, request};
  }

  /// Sectors of `line` are back: calls wake(waiter) for each waiter who lacks nothing more.
  template <class Wake>
  void filled(uint64_t line, SectorMask sectors, Wake&& wake) {
    Entry* const entry = find(line);
    entry->pending &= ~sectors;
    size_t kept = 0;
    for (Waiting& waiting : entry->waiting) {
      waiting.needs &= ~sectors;
      if (waiting.needs) {
        entry->waiting[kept++] = waiting;
      } else {
        wake(waiting.who);
      }
    }
    entry->waiting.erase(entry->waiting.begin() + static_cast<std::ptrdiff_t>(kept), entry->waiting.end());
    if (!entry->pending) release(entry);
  }

  size_t size() const { return entries_.size(); }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  Entry* find(uint64_t line) {
    for (Entry& entry : entries_)
      if (entry.line == line) return &entry;
    return nullptr;
  }
  void release(Entry* entry) {
    if (entry != &entries_.back()) std::swap(*entry, entries_.back());
    entries_.pop_back();
  }

  std::vector<Entry> entries_;
  size_t capacity_, max_waiters_;
};

}  // namespace rayloom::hwmodel
