#pragma once

// Rays that failed, kept for ever: a line a ray of hexadecimal floats, so that nothing is lost in print.
//
//   K1 seed 1 part 3 index 17 ray <o x y z> <t_min> <d x y z> <t_max> triangle <9 floats> triangle ...

#include <rayloom/tests/accel/rational_oracle.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rayloom::bench::numerics {

using accel::Ray;
using accel::test::Point;
using accel::test::Triangle;

struct FailingRay {
  std::string row;
  uint64_t seed = 0, part = 0, index = 0;  ///< of the row's run: which sample of the row, which case of the sample
  Ray ray{};
  std::vector<Triangle> triangles;
};

std::string to_line(const FailingRay& failing);
/// Throws InputError naming `place` when `line` is not what to_line() writes.
FailingRay parse_failing_ray(const std::string& line, const std::string& place);

/// All rays of a file; lines that are empty or begin with # are passed over. Throws InputError.
std::vector<FailingRay> read_failing_rays(const std::string& path);
/// Adds to the end of a file, which is made if it is not there. Throws InputError.
void append_failing_rays(const std::string& path, const std::vector<FailingRay>& rays);

/// Empty when the product treats the ray as the rationals do: decision, t, u, v and facing of every triangle, and, for
/// each instruction set, the closest hit and the number of hits of a structure over all of them. Otherwise what
/// differs.
std::string replay(const FailingRay& failing);

}  // namespace rayloom::bench::numerics
