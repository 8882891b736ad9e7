#include <rayloom/accel/instance_transform.h>
#include <rayloom/runtime/lane.h>

#include <cstring>

namespace rayloom::detail {
namespace {

/// The very ray traversal tests primitives with (SV-30).
accel::Ray object_ray_of(const Invocation& invocation) {
  accel::Ray world;
  std::memcpy(&world, &invocation.ray->desc, sizeof(world));
  return accel::object_ray(*invocation.primitive->instance, world);
}

float3 vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

float3 object_ray_origin(const Invocation& invocation) { return vector(object_ray_of(invocation).origin); }
float3 object_ray_direction(const Invocation& invocation) { return vector(object_ray_of(invocation).direction); }

float3x4 object_to_world(const Invocation& invocation) {
  float3x4 matrix;
  std::memcpy(&matrix, invocation.primitive->instance->object_to_world, sizeof(matrix));
  return matrix;
}

float3x4 world_to_object(const Invocation& invocation) {
  const auto& m = invocation.primitive->instance->world_to_object;
  float3x4 matrix;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) matrix[row][column] = static_cast<float>(m[row][column]);
  return matrix;
}

void mark_branch(Invocation& invocation, uint signature) {
  const Lane& lane = lane_of(invocation);
  if (lane.dispatch().observed) lane.observer.tracer->branch(lane.number, signature);
}

void read_local_root(Invocation& invocation, void* out, uint32_t bytes) {
  std::memset(out, 0, bytes);
  const Lane& lane = lane_of(invocation);
  const ShaderRecord& record = invocation.record;
  const uint64_t address = record.address + SHADER_IDENTIFIER_SIZE_IN_BYTES;
  const uint32_t held = record.table->local_bytes(record.address);
  const std::byte* const host = bytes <= held ? lane.dispatch().shader_memory.host(address, bytes) : nullptr;
  if (!host)
    return lane.report("ST-04", [&] {
      return "LocalRoot reads " + std::to_string(bytes) + " bytes, the record holds " + std::to_string(held) +
             "; zeros are returned";
    });
  std::memcpy(out, host, bytes);
  if (const LaneObserver* observer = shader_memory.observer)
    observer->tracer->access(observer->lane, AccessKind::load, address, bytes, nullptr);
}

void read_global_root(Invocation& invocation, void* out, uint32_t bytes) {
  std::memset(out, 0, bytes);
  const Lane& lane = lane_of(invocation);
  const auto& arguments = lane.dispatch().command.root_arguments;
  if (bytes > arguments.size())
    return lane.report("RS-15", [&] {
      return "GlobalRoot reads " + std::to_string(bytes) + " bytes, the command list set " +
             std::to_string(arguments.size()) + "; zeros are returned";
    });
  std::memcpy(out, arguments.data(), bytes);
}

}  // namespace rayloom::detail
