#pragma once

// Which split triangles a ray has asked its candidate function about. A triangle that lies in several leaves is met
// again in each; one that was committed loses the tie against itself, one that was ignored must not be asked for again.
// Triangles that lie in one leaf need no entry: geometry_flag::split in the leaf tells.

#include <array>
#include <cstdint>
#include <set>

namespace rayloom::accel {

class AskedTriangles {
 public:
  /// Instance, geometry and primitive index.
  using Name = std::array<uint32_t, 3>;

  /// True the first time it is called with `name`. Allocates only for a ray that ignores more than a few triangles.
  bool is_new(const Name& name) {
    for (uint32_t i = 0; i < count_; ++i)
      if (few_[i] == name) return false;
    if (count_ == few_.size()) return more_.insert(name).second;
    few_[count_++] = name;
    return true;
  }

 private:
  std::array<Name, 8> few_;
  uint32_t count_ = 0;
  std::set<Name> more_;
};

}  // namespace rayloom::accel
