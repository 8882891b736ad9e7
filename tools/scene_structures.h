#pragma once

// A scene's structures built straight through accel, as the runtime would build them, and timed one by one.

#include <rayloom/accel/build.h>
#include <rayloom/scenes/scene.h>

#include <memory>
#include <string>
#include <vector>

namespace rayloom::tools {

struct BuiltStructure {
  std::string name;
  accel::StructureInfo info;
  uint64_t reserved_bytes = 0;  ///< what the build asked for before it saw the data
  uint64_t build_time_ns = 0;
};

class SceneStructures {
 public:
  SceneStructures(const scenes::Scene& scene, const accel::BuildSettings& settings);

  /// One for each mesh, in the scene's order, then the top level.
  const std::vector<BuiltStructure>& structures() const { return structures_; }

 private:
  struct Free {
    void operator()(std::byte* block) const {
      ::operator delete[](block, std::align_val_t{accel::structure_alignment});
    }
  };
  using Block = std::unique_ptr<std::byte[], Free>;

  template <class Build>
  void build(const std::string& name, uint64_t result_bytes, Build&& run);
  void build_mesh(const scenes::Scene& scene, const scenes::Mesh& mesh, const accel::BuildSettings& settings);
  void build_instances(const scenes::Scene& scene, const accel::BuildSettings& settings);

  std::vector<Block> blocks_;
  std::vector<BuiltStructure> structures_;
};

}  // namespace rayloom::tools
