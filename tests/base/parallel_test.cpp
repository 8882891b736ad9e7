#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace rayloom;

namespace {

/// Lets a body wait until `expected` threads are inside at once; false after ten seconds without them.
class Rendezvous {
 public:
  explicit Rendezvous(unsigned expected) : expected_(expected) {}
  bool meet() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    ++arrived_;
    while (arrived_ < expected_) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }

 private:
  unsigned expected_;
  std::atomic<unsigned> arrived_ = 0;
};

using Chunks = std::vector<std::pair<uint64_t, uint64_t>>;

Chunks chunks_of(uint64_t count, uint64_t grain) {
  Chunks chunks((count + grain - 1) / grain);
  parallel_for(count, grain, [&](uint64_t begin, uint64_t end) { chunks[begin / grain] = {begin, end}; });
  return chunks;
}

uint64_t fibonacci(TaskGroup& group, unsigned n, std::atomic<uint64_t>& leaves) {
  if (n < 2) return leaves += n;
  group.run([&group, n, &leaves] { fibonacci(group, n - 1, leaves); });
  return fibonacci(group, n - 2, leaves);
}

}  // namespace

TEST_CASE("chunk boundaries depend on count and grain alone", "[parallel]") {
  const Chunks expected = {{0, 3}, {3, 6}, {6, 9}, {9, 10}};
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    CHECK(chunks_of(10, 3) == expected);
  }
  CHECK(chunks_of(3, 100) == Chunks{{0, 3}});
}

TEST_CASE("an empty loop calls nothing and a zero grain counts as one", "[parallel]") {
  std::atomic<int> calls = 0;
  parallel_for(0, 1, [&](uint64_t, uint64_t) { ++calls; });
  CHECK(calls == 0);
  parallel_for(5, 0, [&](uint64_t begin, uint64_t end) { calls += static_cast<int>(end - begin); });
  CHECK(calls == 5);
}

TEST_CASE("as many threads as asked for really run, also more than there are cores", "[parallel]") {
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    CHECK(thread_limit() == threads);
    CHECK(threads_seen() == 0);
    Rendezvous rendezvous(threads);
    std::atomic<unsigned> met = 0, inside = 0, most_inside = 0;
    parallel_for(8 * threads, 1, [&](uint64_t, uint64_t) {
      const unsigned now = ++inside;
      for (unsigned most = most_inside; now > most && !most_inside.compare_exchange_weak(most, now);) continue;
      met += rendezvous.meet();
      --inside;
    });
    CHECK(met == 8 * threads);
    CHECK(most_inside == threads);
    CHECK(threads_seen() == threads);
  }
}

TEST_CASE("the innermost thread limit holds and the outer one comes back", "[parallel]") {
  const unsigned machine = thread_limit();
  {
    const ThreadLimit outer(2);
    {
      const ThreadLimit inner(5);
      CHECK(thread_limit() == 5);
      Rendezvous rendezvous(5);
      std::atomic<unsigned> met = 0;
      parallel_for(5, 1, [&](uint64_t, uint64_t) { met += rendezvous.meet(); });
      CHECK(met == 5);
    }
    CHECK(thread_limit() == 2);
  }
  CHECK(thread_limit() == machine);
  const ThreadLimit all(0);
  CHECK(thread_limit() == machine);
}

TEST_CASE("a loop rethrows the exception of its lowest throwing chunk", "[parallel]") {
  const ThreadLimit limit(7);
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::vector<std::atomic<bool>> ran(100);
    const auto loop = [&] {
      parallel_for(100, 1, [&](uint64_t begin, uint64_t) {
        ran[begin] = true;
        if (begin >= 40) throw std::runtime_error(std::to_string(begin));
      });
    };
    CHECK_THROWS_WITH(loop(), "40");
    for (unsigned i = 0; i <= 40; ++i) REQUIRE(ran[i]);
  }
}

TEST_CASE("loops nest, and a thread waiting for an inner loop starts no other outer chunk", "[parallel]") {
  const ThreadLimit limit(7);
  static thread_local int outer_depth = 0;
  std::atomic<int> deepest = 0;
  std::atomic<uint64_t> total = 0;
  parallel_for(40, 1, [&](uint64_t outer, uint64_t) {
    if (++outer_depth > deepest) deepest = outer_depth;
    // Stolen inner chunks take longer, so that the outer chunk's thread waits while outer chunks are left.
    const auto owner = std::this_thread::get_id();
    parallel_for(4, 1, [&](uint64_t, uint64_t) {
      std::this_thread::sleep_for(std::chrono::milliseconds(std::this_thread::get_id() == owner ? 1 : 4));
      total += outer;
    });
    parallel_invoke([&] { ++total; }, [&] { ++total; });
    --outer_depth;
  });
  CHECK(total == 4 * (39 * 40 / 2) + 2 * 40);
  CHECK(deepest == 1);
}

TEST_CASE("tasks spawn tasks and wait collects them all", "[parallel]") {
  for (const unsigned threads : {1u, 2u, 7u}) {
    const ThreadLimit limit(threads);
    std::atomic<uint64_t> leaves = 0;
    TaskGroup group;
    group.run([&] { fibonacci(group, 15, leaves); });
    group.wait();
    CHECK(leaves == 610);
  }
}

TEST_CASE("a task's exception comes out of wait and nothing leaks", "[parallel]") {
  const auto counted = std::make_shared<int>(0);
  {
    TaskGroup group;
    group.run([] { throw std::runtime_error("task"); });
    for (int i = 0; i < 100; ++i) group.run([counted] {});
    CHECK_THROWS_WITH(group.wait(), "task");
  }
  CHECK(counted.use_count() == 1);
  CHECK_THROWS_WITH(parallel_invoke([] { throw std::runtime_error("first"); }, [] {}), "first");
  CHECK_THROWS_WITH(parallel_invoke([] {}, [] { throw std::runtime_error("second"); }), "second");
}

TEST_CASE("chunks and tasks run in the fixed float environment whatever the caller's is", "[parallel]") {
  std::atomic<int> wrong = 0;
  const auto check = [&wrong] { wrong += std::fegetround() != FE_TONEAREST; };
  std::fesetround(FE_UPWARD);
  parallel_for(64, 1, [&](uint64_t, uint64_t) { check(); });
  TaskGroup group;
  for (int i = 0; i < 64; ++i) group.run(check);
  group.wait();
  const int after = std::fegetround();
  std::fesetround(FE_TONEAREST);
  CHECK(wrong == 0);
  CHECK(after == FE_UPWARD);
}
