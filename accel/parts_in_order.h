#pragma once

// Parts of a structure built by several threads, each part's bytes behind those of the part before.

#include <rayloom/accel/part_builder.h>

#include <condition_variable>
#include <memory>
#include <mutex>

namespace rayloom::accel {

/// A part and what is known of it once it is built.
struct Part {
  Subtree where;
  Pieces pieces;
};

/// Sums over the bytes of parts.
struct PartSums {
  uint32_t node_count = 0, leaf_count = 0;
  double area = 0;  ///< over nodes and leaves

  void add(const WideBytes& wide);
};

/// Parts are built in memory of their own. Where one goes follows from the bytes of all before: whoever finishes the
/// last of those moves it there, so that nobody waits for a slower part while there are others to build.
class PartsInOrder {
 public:
  /// Builds the parts into `block` from `granule` on.
  PartsInOrder(const TriangleCurve& order, const TreeInput& input, std::span<Part> parts, std::span<std::byte> block,
               uint32_t granule);

  uint32_t granule() const { return granule_; }  ///< behind the last part
  const PartSums& sums() const { return sums_; }

 private:
  using Builder = std::unique_ptr<PartBuilder>;
  struct Task {
    size_t part;
    Builder builder;  ///< null: nothing is left to do
  };
  /// Parts, and bytes of the block, that fell to a thread.
  struct Share {
    size_t first, last;
    uint64_t begin, end;
  };

  void work();
  Task take();
  Share place(Task task);
  uint64_t page_after_next() const;
  void move(const Share& share);
  void give_up();

  const TriangleCurve& order_;
  const TreeInput& input_;
  std::span<Part> parts_;
  std::span<std::byte> block_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Builder> free_;
  size_t unmade_;                 ///< builders
  size_t next_ = 0, placed_ = 0;  ///< the first part that nobody builds, the first without a place
  std::vector<Builder> built_;    ///< by part, until it is moved
  std::vector<uint32_t> place_;   ///< granules, by part
  uint32_t granule_;
  uint64_t populated_ = 0;  ///< bytes of the block
  PartSums sums_;
};

}  // namespace rayloom::accel
