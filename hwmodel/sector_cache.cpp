#include <rayloom/hwmodel/sector_cache.h>

#include <algorithm>

namespace rayloom::hwmodel {

SectorCache::SectorCache(uint32_t sets, uint32_t ways) : ways_(size_t{sets} * ways), sets_(sets), ways_per_set_(ways) {}

SectorCache::Way* SectorCache::find(uint64_t line) {
  Way* const set = &ways_[line % sets_ * ways_per_set_];
  Way* const end = set + ways_per_set_;
  Way* const found = std::find_if(set, end, [&](const Way& way) { return way.valid && way.line == line; });
  return found == end ? nullptr : found;
}

SectorCache::Way& SectorCache::victim(uint64_t line) {
  Way* const set = &ways_[line % sets_ * ways_per_set_];
  return *std::min_element(set, set + ways_per_set_,
                           [](const Way& a, const Way& b) { return a.last_use < b.last_use; });
}

SectorMask SectorCache::lookup(uint64_t line) {
  Way* const way = find(line);
  if (!way) return 0;
  way->last_use = ++clock_;
  return way->valid;
}

std::optional<SectorCache::Evicted> SectorCache::fill(uint64_t line, SectorMask sectors, bool dirty) {
  std::optional<Evicted> evicted;
  Way* way = find(line);
  if (!way) {
    way = &victim(line);
    if (way->dirty) evicted = Evicted{way->line, way->dirty};
    *way = Way{line, 0, 0, 0};
  }
  way->valid |= sectors;
  if (dirty) way->dirty |= sectors;
  way->last_use = ++clock_;
  return evicted;
}

}  // namespace rayloom::hwmodel
