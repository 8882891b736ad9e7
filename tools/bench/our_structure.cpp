#include <rayloom/tools/bench/our_structure.h>

#include <rayloom/tools/bench/measure.h>

#include <cstring>
#include <new>
#include <sys/mman.h>

namespace rayloom::bench {
namespace {

constexpr uint64_t huge_page_bytes = uint64_t{2} << 20;

uint64_t round_up(uint64_t bytes) { return (bytes + huge_page_bytes - 1) / huge_page_bytes * huge_page_bytes; }

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

/// Memory that is all in huge pages where the system has them, as the peer's own allocator asks for.
OurStructure::Block::Block(uint64_t bytes) : mapped_(round_up(bytes) + huge_page_bytes) {
  void* const memory =
      mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  mapping_ = static_cast<std::byte*>(memory);
  const auto address = reinterpret_cast<uintptr_t>(mapping_);
  data = mapping_ + (round_up(address) - address);
  madvise(data, round_up(bytes), MADV_HUGEPAGE);
}

OurStructure::Block::~Block() {
  if (mapping_) munmap(mapping_, mapped_);
}

template <class Sizes, class Build>
void OurStructure::build(const Sizes& sizes, const Build& build) {
  const Block& block = blocks_.emplace_back(sizes.result_bytes);
  build_time_.add([&] { bytes_ += build(std::span(block.data, sizes.result_bytes)); });
  const accel::StructureInfo info = accel::structure_info(block.data);
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
    descs.push_back(describe(instance, static_cast<uint32_t>(descs.size()), blocks_[instance.mesh].data));
  }
  build(accel::top_level_sizes(descs.size(), settings), [&](std::span<std::byte> result) {
    return accel::build_top_level(descs, accel::AddressSpace{}, settings, result);
  });
}

LazyParts OurStructure::lazy_parts() const {
  LazyParts sum;
  for (const Block& block : blocks_) {
    const accel::StructureInfo info = accel::structure_info(block.data);
    sum.all += info.parts;
    sum.built += info.built_parts;
  }
  return sum;
}

}  // namespace rayloom::bench
