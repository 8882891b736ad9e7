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
  Piece* first_piece = nullptr;  ///< of memory for most_pieces
  size_t piece_count = 0;

  void keep(const Pieces& pieces) {
    std::uninitialized_copy(pieces.begin(), pieces.end(), first_piece);
    piece_count = pieces.size();
  }
  std::span<const Piece> pieces() const { return {first_piece, piece_count}; }
};

/// Parts are built in memory of their own and moved to where they go, which follows from the bytes of all before, by
/// the thread that built them, in whose cache they are. A part waits for slower ones before it while its thread builds
/// on.
class PartsInOrder {
 public:
  /// Builds the parts into `block` from `granule` on.
  PartsInOrder(const TriangleCurve& order, const TreeInput& input, std::span<Part> parts, std::span<std::byte> block,
               uint32_t granule);

  uint32_t granule() const { return first_granule_ + sums_.granules; }  ///< behind the last part
  const WideSums& sums() const { return sums_; }

 private:
  class Worker;

  size_t take();
  uint32_t place_of_next(size_t part);
  size_t finish(size_t part, const WideSums& sums);
  size_t wait_for_place(size_t part);
  void move(size_t part, PartBytes& bytes);
  uint64_t page_after_next() const;
  void give_up();

  const TriangleCurve& order_;
  const TreeInput& input_;
  std::span<Part> parts_;
  std::span<std::byte> block_;
  std::mutex mutex_;
  std::condition_variable placed_more_;
  size_t next_ = 0, placed_ = 0;  ///< the first part that nobody builds, the first without a place
  std::vector<WideSums> built_;   ///< by part
  std::vector<uint32_t> place_;   ///< granules, by part
  uint32_t first_granule_;
  uint64_t populated_ = 0;  ///< bytes of the block
  bool failed_ = false;
  WideSums sums_;  ///< of all that have a place
};

}  // namespace rayloom::accel
