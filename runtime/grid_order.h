#pragma once

// Which thread of a DispatchRays grid is lane l of warp w: linear index w * warp_size + l, counted through slices of z,
// in each through bands of 4 rows, in each band through tiles of 8 columns, in each tile row by row. Tiles at the edges
// are cut, never padded, so every warp but the last is full.

#include <algorithm>
#include <cstdint>

namespace rayloom {

struct GridIndex {
  uint32_t x = 0, y = 0, z = 0;
};

inline constexpr uint32_t grid_tile_width = 8, grid_tile_height = 4;

/// width, height > 0; `linear` below width * height * depth.
constexpr GridIndex grid_index(uint32_t width, uint32_t height, uint64_t linear) {
  const uint64_t slice = uint64_t{width} * height;
  const uint64_t in_slice = linear % slice;
  const uint64_t band = in_slice / (uint64_t{width} * grid_tile_height);
  const uint64_t first_row = band * grid_tile_height;
  const uint64_t rows = std::min<uint64_t>(grid_tile_height, height - first_row);
  const uint64_t in_band = in_slice - first_row * width;
  const uint64_t tile = in_band / (grid_tile_width * rows);
  const uint64_t first_column = tile * grid_tile_width;
  const uint64_t columns = std::min<uint64_t>(grid_tile_width, width - first_column);
  const uint64_t in_tile = in_band - tile * grid_tile_width * rows;
  return {static_cast<uint32_t>(first_column + in_tile % columns), static_cast<uint32_t>(first_row + in_tile / columns),
          static_cast<uint32_t>(linear / slice)};
}

/// grid_index() of one linear index after another, without divisions.
class GridWalk {
 public:
  GridWalk(uint32_t width, uint32_t height, uint64_t linear)
      : width_(width), height_(height), at_(grid_index(width, height, linear)) {
    first_column_ = at_.x / grid_tile_width * grid_tile_width;
    first_row_ = at_.y / grid_tile_height * grid_tile_height;
    enter_tile();
  }

  const GridIndex& operator*() const { return at_; }
  GridWalk& operator++() {
    if (++at_.x == end_column_) next_row();
    return *this;
  }

 private:
  void enter_tile() {
    end_column_ = std::min(width_, first_column_ + grid_tile_width);
    end_row_ = std::min(height_, first_row_ + grid_tile_height);
  }
  void next_row() {
    at_.x = first_column_;
    if (++at_.y == end_row_) next_tile();
  }
  void next_tile() {
    if (end_column_ == width_) {
      const bool slice_ends = end_row_ == height_;
      first_row_ = slice_ends ? 0 : end_row_;
      at_.z += slice_ends;
      first_column_ = 0;
    } else {
      first_column_ = end_column_;
    }
    at_.x = first_column_;
    at_.y = first_row_;
    enter_tile();
  }

  uint32_t width_, height_;
  GridIndex at_;
  uint32_t first_column_, first_row_, end_column_ = 0, end_row_ = 0;
};

}  // namespace rayloom
