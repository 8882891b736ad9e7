#include <rayloom/tools/bench/our_structure.h>

#include <rayloom/tools/bench/measure.h>

#include <cstring>
#include <new>
#include <sys/mman.h>

namespace rayloom::bench {
namespace {

/// Memory in huge pages where the system has them, as the peer's own allocator and the runtime's Device ask for.
std::byte* map_huge(uint64_t bytes) {
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE);
  return static_cast<std::byte*>(memory);
}

accel::TriangleGeometry geometry_of(const BenchMesh& mesh, uint32_t flags) {
  accel::TriangleGeometry geometry;
  geometry.vertices = reinterpret_cast<const std::byte*>(mesh.vertices.data());
  geometry.vertex_count = mesh.vertex_count();
  geometry.indices = reinterpret_cast<const std::byte*>(mesh.indices.data());
  geometry.index_format = accel::IndexFormat::uint32;
  geometry.triangle_count = mesh.triangle_count();
  geometry.flags = flags;
  return geometry;
}

accel::InstanceDesc describe(const PeerInstance& instance, uint32_t index, const std::byte* bottom_level) {
  accel::InstanceDesc desc{};
  std::memcpy(desc.transform, instance.transform.data(), sizeof desc.transform);
  desc.instance_id = index & 0xFFFFFFu;
  desc.instance_mask = 0xFF;
  desc.bottom_level_address = reinterpret_cast<uint64_t>(bottom_level);
  return desc;
}

}  // namespace

template <class Sizes, class Build>
void OurStructure::build(const Sizes& sizes, const Build& build) {
  const uint64_t mapped = sizes.result_bytes;
  Block& block = blocks_.emplace_back(Block{map_huge(mapped), mapped});
  build_time_.add([&] { bytes_ += build(std::span(block.memory, mapped)); });
  const accel::StructureInfo info = accel::structure_info(block.memory);
  if (!info.top_level && info.primitives >= largest_.primitives) largest_ = info;
}

OurStructure::OurStructure(const BenchScene& scene, accel::BuildSettings settings, uint32_t geometry_flags) {
  for (const BenchMesh& mesh : scene.meshes) {
    const accel::TriangleGeometry geometries[]{geometry_of(mesh, geometry_flags)};
    const std::span<const accel::TriangleGeometry> inputs(geometries);
    build(accel::bottom_level_sizes(inputs, settings),
          [&](std::span<std::byte> result) { return accel::build_bottom_level(inputs, settings, result); });
  }
  if (!scene.two_level()) return;
  std::vector<accel::InstanceDesc> descs;
  for (const PeerInstance& instance : scene.instances) {
    descs.push_back(describe(instance, static_cast<uint32_t>(descs.size()), blocks_[instance.mesh].memory));
  }
  build(accel::top_level_sizes(descs.size(), settings), [&](std::span<std::byte> result) {
    return accel::build_top_level(descs, accel::AddressSpace{}, settings, result);
  });
}

OurStructure::~OurStructure() {
  for (const Block& block : blocks_) munmap(block.memory, block.mapped);
}

}  // namespace rayloom::bench
