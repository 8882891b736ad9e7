// Every library of the package together, as a renderer would link them.
#include <rayloom/base/det_math.h>
#include <rayloom/base/fiber.h>
#include <rayloom/base/json.h>
#include <rayloom/base/parallel.h>
#include <rayloom/base/version.h>

#include <atomic>
#include <cstdio>

int main() {
  std::atomic<int> sum = 0;
  rayloom::parallel_for(10, 3, [&](uint64_t begin, uint64_t end) { sum += static_cast<int>(end - begin); });
  rayloom::Fiber fiber;
  fiber.start([](void* total) { ++*static_cast<std::atomic<int>*>(total); }, &sum);
  fiber.resume();
  std::printf("Rayloom %s\n", rayloom::version_text().c_str());
  rayloom::write_json("-", rayloom::json_document("consumer", 1));
  return sum == 11 && rayloom::det::cos(0.0) == 1.0 ? 0 : 1;
}
