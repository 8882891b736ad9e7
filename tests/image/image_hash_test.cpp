// Small renders of every program, bit for bit the same on every machine. hashes.txt says how to update.

#include "picture_hash.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <vector>

using namespace rayloom;
using test::PictureCase;

namespace {

std::vector<PictureCase> cases() {
  std::vector<PictureCase> list;
  for (const char* scene : {"cornell", "spheres", "masked"})
    for (const shaders::ProgramInfo& program : shaders::programs()) list.push_back({scene, program.name});
  return list;
}

}  // namespace

TEST_CASE("renders have the bits on record") {
  const std::string path = RAYLOOM_HASHES;
  std::map<std::string, uint64_t> seen;
  for (const PictureCase& picture : cases()) seen[picture.key()] = test::picture_hash(test::render_case(picture));
  if (std::getenv("RAYLOOM_UPDATE_HASHES")) test::write_hashes(path, seen);
  const auto expected = test::read_hashes(path);
  CHECK(expected.size() == seen.size());
  for (const auto& [key, hash] : seen) {
    CAPTURE(key);
    const auto found = expected.find(key);
    REQUIRE(found != expected.end());
    CHECK(found->second == hash);
  }
}
