#include <rayloom/accel/build.h>
#include <rayloom/base/error.h>
#include <rayloom/runtime/execute.h>

#include <cinttypes>
#include <cstdio>

namespace rayloom::detail {
namespace {

using Inputs = BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS;

[[noreturn]] void fail(const std::string& object, const std::string& rule) {
  throw InputError("BuildRaytracingAccelerationStructure", object, rule);
}

/// Host memory behind `count` items of `size` bytes, `stride` apart; InputError when it is not all committed.
const std::byte* resolve(const DeviceMemory& memory, const std::string& object, uint64_t address, uint64_t stride,
                         uint64_t count, uint64_t size) {
  if (count == 0) return nullptr;
  if (stride && (count - 1) > (memory.reserved_bytes() - 1) / stride)
    fail(object, "is larger than the device's memory");
  const uint64_t bytes = (count - 1) * stride + size;
  if (memory.holds(address, bytes)) return memory.host(address);
  char text[96];
  std::snprintf(text, sizeof(text), "0x%" PRIx64 " does not hold the %" PRIu64 " bytes it is said to hold", address,
                bytes);
  fail(object, text);
}

void check_alignment(const std::string& object, uint64_t value, uint64_t alignment, const char* row) {
  if (value % alignment) fail(object, "is no multiple of " + std::to_string(alignment) + " [" + row + "]");
}

accel::IndexFormat index_format(const RAYTRACING_GEOMETRY_TRIANGLES_DESC& desc, const std::string& object) {
  switch (desc.IndexFormat) {
    case FORMAT_UNKNOWN:
      return accel::IndexFormat::none;
    case FORMAT_R16_UINT:
      return accel::IndexFormat::uint16;
    case FORMAT_R32_UINT:
      return accel::IndexFormat::uint32;
  }
  fail(object + ".IndexFormat", "is none of UNKNOWN, R16_UINT, R32_UINT [BI-05]");
}

uint32_t index_bytes(accel::IndexFormat format) { return format == accel::IndexFormat::uint16 ? 2 : 4; }

/// Counts and flags alone: what sizes follow from.
accel::TriangleGeometry triangle_counts(const RAYTRACING_GEOMETRY_DESC& geometry, const std::string& object) {
  const RAYTRACING_GEOMETRY_TRIANGLES_DESC& desc = geometry.Triangles;
  if (desc.VertexFormat != FORMAT_R32G32B32_FLOAT)
    fail(object + ".VertexFormat", "is not R32G32B32_FLOAT, the only format of this version [BI-06]");
  accel::TriangleGeometry result;
  result.vertex_stride = static_cast<uint32_t>(desc.VertexBuffer.StrideInBytes);  // BI-12: the low 32 bits count
  result.vertex_count = desc.VertexCount;
  result.index_format = index_format(desc, object);
  const bool indexed = result.index_format != accel::IndexFormat::none;
  result.triangle_count = (indexed ? desc.IndexCount : desc.VertexCount) / 3;
  result.flags = geometry.Flags;
  return result;
}

accel::AabbGeometry aabb_counts(const RAYTRACING_GEOMETRY_DESC& geometry) {
  accel::AabbGeometry result;
  result.stride = geometry.AABBs.AABBs.StrideInBytes;
  result.box_count = geometry.AABBs.AABBCount;
  result.flags = geometry.Flags;
  return result;
}

std::string object_name(size_t index, const char* kind) { return "geometries[" + std::to_string(index) + "]." + kind; }

accel::TriangleGeometry resolve_triangles(const DeviceMemory& memory, const RAYTRACING_GEOMETRY_DESC& geometry,
                                          const std::string& object) {
  const RAYTRACING_GEOMETRY_TRIANGLES_DESC& desc = geometry.Triangles;
  accel::TriangleGeometry result = triangle_counts(geometry, object);
  check_alignment(object + ".VertexBuffer.StartAddress", desc.VertexBuffer.StartAddress, 4, "BI-12");
  check_alignment(object + ".VertexBuffer.StrideInBytes", result.vertex_stride, 4, "BI-12");
  result.vertices = resolve(memory, object + ".VertexBuffer", desc.VertexBuffer.StartAddress, result.vertex_stride,
                            result.vertex_count, 12);
  if (result.index_format != accel::IndexFormat::none) {
    const uint32_t bytes = index_bytes(result.index_format);
    check_alignment(object + ".IndexBuffer", desc.IndexBuffer, bytes, "BI-05");
    result.indices = resolve(memory, object + ".IndexBuffer", desc.IndexBuffer, bytes, desc.IndexCount, bytes);
  }
  if (desc.Transform3x4) {
    check_alignment(object + ".Transform3x4", desc.Transform3x4, RAYTRACING_TRANSFORM3X4_BYTE_ALIGNMENT, "BI-16");
    result.transform =
        reinterpret_cast<const float*>(resolve(memory, object + ".Transform3x4", desc.Transform3x4, 0, 1, 48));
  }
  return result;
}

accel::AabbGeometry resolve_aabbs(const DeviceMemory& memory, const RAYTRACING_GEOMETRY_DESC& geometry,
                                  const std::string& object) {
  accel::AabbGeometry result = aabb_counts(geometry);
  check_alignment(object + ".StartAddress", geometry.AABBs.AABBs.StartAddress, RAYTRACING_AABB_BYTE_ALIGNMENT, "BI-20");
  check_alignment(object + ".StrideInBytes", result.stride, RAYTRACING_AABB_BYTE_ALIGNMENT, "BI-20");
  result.boxes = resolve(memory, object, geometry.AABBs.AABBs.StartAddress, result.stride, result.box_count,
                         sizeof(RAYTRACING_AABB));
  return result;
}

bool holds_triangles(std::span<const RAYTRACING_GEOMETRY_DESC> geometries) {
  return geometries.empty() || geometries[0].Type == RAYTRACING_GEOMETRY_TYPE_TRIANGLES;
}

/// BI-03.
void check_one_type(std::span<const RAYTRACING_GEOMETRY_DESC> geometries) {
  for (size_t i = 0; i < geometries.size(); ++i)
    if (geometries[i].Type != geometries[0].Type ||
        geometries[i].Type > RAYTRACING_GEOMETRY_TYPE_PROCEDURAL_PRIMITIVE_AABBS)
      fail("geometries[" + std::to_string(i) + "].Type", "differs from that of geometries[0] [BI-03]");
}

template <class Geometry, class Convert>
std::vector<Geometry> convert_all(std::span<const RAYTRACING_GEOMETRY_DESC> geometries, const char* kind,
                                  Convert convert) {
  std::vector<Geometry> result;
  for (size_t i = 0; i < geometries.size(); ++i) result.push_back(convert(geometries[i], object_name(i, kind)));
  return result;
}

accel::BuildSizes bottom_level_sizes(std::span<const RAYTRACING_GEOMETRY_DESC> geometries, uint32_t flags) {
  if (!holds_triangles(geometries))
    return accel::bottom_level_sizes(
        convert_all<accel::AabbGeometry>(geometries, "AABBs",
                                         [](const auto& geometry, const auto&) { return aabb_counts(geometry); }),
        flags);
  return accel::bottom_level_sizes(convert_all<accel::TriangleGeometry>(geometries, "Triangles", triangle_counts),
                                   flags);
}

/// What the rules say of trailing indices (BI-27).
void report_odd_counts(std::span<const RAYTRACING_GEOMETRY_DESC> geometries, ValidationLog& log) {
  for (size_t i = 0; i < geometries.size(); ++i) {
    const RAYTRACING_GEOMETRY_TRIANGLES_DESC& desc = geometries[i].Triangles;
    const uint32_t count = desc.IndexFormat == FORMAT_UNKNOWN ? desc.VertexCount : desc.IndexCount;
    if (count % 3)
      log.add("BI-27", i,
              "geometries[" + std::to_string(i) + "]: " + std::to_string(count) +
                  " indices are not a multiple of 3; the last are ignored");
  }
}

constexpr uint32_t perform_update = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PERFORM_UPDATE;

/// The flags a structure keeps, and where an update finds what it updates: null for a build.
struct Target {
  uint32_t flags;
  const std::byte* source;
  std::span<std::byte> result;
};

template <class Geometry>
void build_or_update(const std::vector<Geometry>& geometries, const Target& target) {
  const std::span<const Geometry> span(geometries);
  if (target.source)
    accel::refit_bottom_level(span, target.flags, target.source, target.result);
  else
    accel::build_bottom_level(span, target.flags, target.result);
}

void build_bottom_level(const BuildCommand& command, const DeviceMemory& memory, ValidationLog& log,
                        const Target& target) {
  const std::span<const RAYTRACING_GEOMETRY_DESC> geometries = command.geometries;
  if (holds_triangles(geometries)) {
    report_odd_counts(geometries, log);
    build_or_update(convert_all<accel::TriangleGeometry>(geometries, "Triangles",
                                                         [&](const auto& geometry, const std::string& object) {
                                                           return resolve_triangles(memory, geometry, object);
                                                         }),
                    target);
  } else {
    build_or_update(convert_all<accel::AabbGeometry>(geometries, "AABBs",
                                                     [&](const auto& geometry, const std::string& object) {
                                                       return resolve_aabbs(memory, geometry, object);
                                                     }),
                    target);
  }
}

/// The instance descs from either layout (TL-02), copied so that both are one span.
std::vector<accel::InstanceDesc> read_instances(const Inputs& inputs, const DeviceMemory& memory) {
  const uint64_t count = inputs.NumDescs;
  std::vector<accel::InstanceDesc> instances(count);
  const bool pointers = inputs.DescsLayout == ELEMENTS_LAYOUT_ARRAY_OF_POINTERS;
  check_alignment("InstanceDescs", inputs.InstanceDescs, pointers ? 8 : RAYTRACING_INSTANCE_DESCS_BYTE_ALIGNMENT,
                  "TL-02");
  const uint64_t item = pointers ? sizeof(uint64_t) : sizeof(accel::InstanceDesc);
  const std::byte* const source = resolve(memory, "InstanceDescs", inputs.InstanceDescs, item, count, item);
  if (!pointers && count) std::memcpy(instances.data(), source, count * item);
  for (uint64_t i = 0; pointers && i < count; ++i) {
    const std::string object = "InstanceDescs[" + std::to_string(i) + "]";
    uint64_t address;
    std::memcpy(&address, source + i * item, sizeof(address));
    check_alignment(object, address, RAYTRACING_INSTANCE_DESCS_BYTE_ALIGNMENT, "TL-02");
    std::memcpy(&instances[i], resolve(memory, object, address, 0, 1, sizeof(accel::InstanceDesc)),
                sizeof(accel::InstanceDesc));
  }
  return instances;
}

void build_top_level(const BuildCommand& command, const DeviceMemory& memory, const Target& target) {
  const std::vector<accel::InstanceDesc> instances = read_instances(command.desc.Inputs, memory);
  for (size_t i = 0; i < instances.size(); ++i) {
    const uint64_t bottom = instances[i].bottom_level_address;
    const std::string object = "InstanceDescs[" + std::to_string(i) + "].AccelerationStructure";
    check_alignment(object, bottom, accel::structure_alignment, "BI-22");
    if (bottom) resolve(memory, object, bottom, 0, 1, sizeof(accel::StructureHeader));
  }
  if (target.source)
    accel::refit_top_level(instances, memory.addresses(), target.flags, target.source, target.result);
  else
    accel::build_top_level(instances, memory.addresses(), target.flags, target.result);
}

/// The structure at `address`, all of whose bytes are the device's.
const std::byte* resolve_source(const DeviceMemory& memory, uint64_t address) {
  constexpr const char* object = "SourceAccelerationStructureData";
  const std::byte* const block = resolve(memory, object, address, 0, 1, sizeof(accel::StructureHeader));
  return resolve(memory, object, address, 0, 1, accel::structure_info(block).bytes);
}

Target resolve_target(const BuildCommand& command, const DeviceMemory& memory) {
  const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_DESC& desc = command.desc;
  const uint32_t flags = desc.Inputs.Flags & ~perform_update;
  const std::byte* const source =
      (desc.Inputs.Flags & perform_update) ? resolve_source(memory, desc.SourceAccelerationStructureData) : nullptr;
  const uint64_t bytes = source ? accel::structure_info(source).bytes
                                : prebuild_info(desc.Inputs, command.geometries).ResultDataMaxSizeInBytes;
  resolve(memory, "DestAccelerationStructureData", desc.DestAccelerationStructureData, 0, 1, bytes);
  return {flags, source, {memory.host(desc.DestAccelerationStructureData), bytes}};
}

}  // namespace

std::vector<RAYTRACING_GEOMETRY_DESC> copy_geometries(const Inputs& inputs) {
  std::vector<RAYTRACING_GEOMETRY_DESC> geometries;
  if (inputs.Type != RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL || inputs.NumDescs == 0) return geometries;
  if (!inputs.pGeometryDescs) fail("pGeometryDescs", "is null, NumDescs is not 0");
  for (uint32_t i = 0; i < inputs.NumDescs; ++i)
    geometries.push_back(inputs.DescsLayout == ELEMENTS_LAYOUT_ARRAY ? inputs.pGeometryDescs[i]
                                                                     : *inputs.ppGeometryDescs[i]);
  check_one_type(geometries);
  return geometries;
}

RAYTRACING_ACCELERATION_STRUCTURE_PREBUILD_INFO prebuild_info(const Inputs& inputs,
                                                              std::span<const RAYTRACING_GEOMETRY_DESC> geometries) {
  const bool top = inputs.Type == RAYTRACING_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL;
  const uint32_t flags = inputs.Flags & ~perform_update;  // RW-17: the same sizes
  const accel::BuildSizes sizes =
      top ? accel::top_level_sizes(inputs.NumDescs, flags) : bottom_level_sizes(geometries, flags);
  constexpr uint64_t alignment = accel::structure_alignment;
  return {(sizes.result_bytes + alignment - 1) / alignment * alignment, sizes.scratch_bytes, 0};
}

void build_acceleration_structure(const BuildCommand& command, const DeviceMemory& memory, ValidationLog& log) {
  const Target target = resolve_target(command, memory);
  if (command.desc.Inputs.Type == RAYTRACING_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL)
    build_top_level(command, memory, target);
  else
    build_bottom_level(command, memory, log, target);
}

}  // namespace rayloom::detail
