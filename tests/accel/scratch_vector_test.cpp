#include <rayloom/accel/build.h>
#include <rayloom/accel/scratch_vector.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <cstdint>

using namespace rayloom;
using namespace rayloom::accel;

TEST_CASE("scratch memory serves again, for builds of about the size") {
  release_build_scratch();
  constexpr size_t count = size_t{4} << 20;
  const void* first = nullptr;
  {
    ScratchVector<uint32_t> vector(count);
    vector.back() = 1;
    first = vector.data();
  }
  {
    const ScratchVector<uint32_t> again(count - 1000), other(count), small(count / 8);
    CHECK(again.data() == first);
    CHECK(other.data() != first);
    CHECK(small.data() != first);
  }
  release_build_scratch();
}

TEST_CASE("so does scratch memory of less than a huge page") {
  release_build_scratch();
  const void* first = nullptr;
  {
    ScratchVector<uint32_t> vector(40000);
    vector.back() = 1;
    first = vector.data();
  }
  {
    const ScratchVector<uint32_t> again(39000), other(40000);
    CHECK(again.data() == first);
    CHECK(other.data() != first);
  }
  release_build_scratch();
}

TEST_CASE("scratch memory may be taken from many threads") {
  std::vector<uint32_t> wrong(64);
  parallel_for(wrong.size(), 1, [&](uint64_t begin, uint64_t) {
    ScratchVector<uint64_t> vector(size_t{300000} + 1000 * begin);
    for (uint64_t& x : vector) x = begin;
    for (const uint64_t x : vector) wrong[begin] += x != begin;
  });
  for (const uint32_t w : wrong) CHECK(w == 0);
  release_build_scratch();
}

TEST_CASE("a vector filled by value holds the values") {
  const ScratchVector<int> vector(1000, 7);
  for (const int x : vector) REQUIRE(x == 7);
}
