#include <rayloom/base/error.h>
#include <rayloom/scenes/gltf/load_gltf.h>
#include <rayloom/scenes/summary.h>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace rayloom;
  try {
    const scenes::Scene scene =
        scenes::load_gltf_bytes({reinterpret_cast<const std::byte*>(data), size}, "fuzz", "/nonexistent");
    scenes::summarize(scene);
  } catch (const InputError&) {
  }
  return 0;
}
