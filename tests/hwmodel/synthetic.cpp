#include "synthetic.h"

#include <algorithm>
#include <limits>

namespace rayloom::hwmodel::test {

using namespace accel;

namespace {

constexpr uint64_t cell_bytes = 512;
constexpr float infinity = std::numeric_limits<float>::infinity();

void clear(Node8& node) {
  for (auto& axis : node.bounds)
    for (int lane = 0; lane < 8; ++lane) axis[0][lane] = infinity, axis[1][lane] = -infinity;
  std::fill(node.child, node.child + 8, 0);
}

void set_child(Node8& node, uint64_t offset, bool leaf) {
  for (auto& axis : node.bounds) axis[0][0] = -1, axis[1][0] = 1;
  node.child[0] = static_cast<uint32_t>(offset / granule_bytes) | (leaf ? node_ref::leaf_bit : 0);
}

// Header at the block's start, node i in cell i + 1.
Chain make_nodes(Arena& arena, uint32_t nodes, StructureKind kind, uint32_t leaves) {
  Chain chain;
  const uint64_t bytes = cell_bytes * (nodes + 1 + leaves);
  chain.address = arena.allocate(bytes, cell_bytes);
  StructureHeader header{};
  header.magic = structure_magic;
  header.kind = kind;
  header.bytes = bytes;
  header.root = cell_bytes / granule_bytes;
  header.depth = nodes;
  std::fill(header.bounds_min, header.bounds_min + 3, -1.0f);
  std::fill(header.bounds_max, header.bounds_max + 3, 1.0f);
  header.node_count = nodes;
  header.leaf_count = leaves;
  header.geometry_count = 1;
  header.pad_scale = 1;
  arena.at<StructureHeader>(chain.address) = header;
  for (uint32_t i = 0; i < nodes; ++i) {
    chain.nodes.push_back(chain.address + cell_bytes * (i + 1));
    auto& node = arena.at<Node8>(chain.nodes.back());
    clear(node);
    if (i + 1 < nodes + leaves) set_child(node, cell_bytes * (i + 2), i + 1 == nodes);
  }
  return chain;
}

}  // namespace

Arena::Arena(uint64_t bytes) : storage_(bytes + 8192) {
  const auto start = reinterpret_cast<uintptr_t>(storage_.data());
  base_ = storage_.data() + (4096 - start % 4096);
}

uint64_t Arena::allocate(uint64_t bytes, uint64_t alignment) {
  const uint64_t address = (used_ + alignment - 1) / alignment * alignment;
  used_ = address + bytes;
  if (used_ > storage_.size() - 4096) throw std::bad_alloc();
  return address;
}

Chain make_chain(Arena& arena, uint32_t nodes, uint32_t triangles, uint32_t geometry_flags) {
  const Chain chain = make_nodes(arena, nodes, StructureKind::triangles, triangles > 0);
  if (triangles == 0) return chain;
  auto& leaf = arena.at<PlainTriangleLeaf>(chain.address + cell_bytes * (nodes + 1));
  for (int lane = 0; lane < 8; ++lane) {
    const bool used = lane < static_cast<int>(triangles);
    const float z = used ? static_cast<float>(lane) / 16 : std::numeric_limits<float>::quiet_NaN();
    const float corners[3][3] = {{-0.5f, -0.5f, z}, {0.75f, -0.5f, z}, {0, 0.75f, z}};
    for (int vertex = 0; vertex < 3; ++vertex) {
      leaf.corner[vertex][lane] = static_cast<uint8_t>(8 * vertex + lane);
      for (int axis = 0; axis < 3; ++axis) leaf.vertex[axis][vertex][lane] = used ? corners[vertex][axis] : z;
    }
    leaf.primitive[lane] = used ? static_cast<uint32_t>(lane) : no_index;
  }
  leaf.count = static_cast<uint8_t>(triangles);
  leaf.slots = TriangleLeaf::plain_slots;
  leaf.geometry = geometry_flags << 24;
  return chain;
}

Chain make_procedural_chain(Arena& arena, uint32_t nodes, uint32_t boxes) {
  const Chain chain = make_nodes(arena, nodes, StructureKind::procedurals, 1);
  auto& leaf = arena.at<ProceduralLeaf8>(chain.address + cell_bytes * (nodes + 1));
  for (int lane = 0; lane < 8; ++lane) {
    const bool used = lane < static_cast<int>(boxes);
    for (auto& axis : leaf.bounds) axis[0][lane] = used ? -1 : infinity, axis[1][lane] = used ? 1 : -infinity;
    leaf.primitive[lane] = used ? static_cast<uint32_t>(lane) : no_index;
    leaf.geometry[lane] = 0;
  }
  return chain;
}

Ray down_z() { return {{0, 0, -2}, 0, {0, 0, 1}, 1000}; }

Hit LaneScript::trace(uint64_t structure, const Ray& ray, uint32_t flags, CandidateFunction candidate, void* user) {
  TraceCall call;
  call.lane = lane_;
  call.structure_address = structure;
  call.request.ray = ray;
  call.request.ray_flags = flags;
  call.request.candidate = candidate;
  call.request.user = user;
  tracer_.trace({&call, 1});
  return call.hit;
}

Capture capture_lanes(const Arena& arena, std::vector<ShaderInfo> shaders, uint32_t lanes,
                      const std::function<void(LaneScript&, uint32_t)>& script, uint32_t warp_size) {
  RecordingTracer tracer;
  const uint64_t warps = (lanes + warp_size - 1) / warp_size;
  tracer.begin_dispatch({lanes, 1, 1, warp_size, warps, shaders, arena.addresses()});
  for (uint64_t warp = 0; warp < warps; ++warp) {
    std::unique_ptr<WarpTracer> recorder = tracer.begin_warp(warp);
    for (uint32_t lane = 0; lane < warp_size && warp * warp_size + lane < lanes; ++lane) {
      LaneScript lane_script(*recorder, lane);
      script(lane_script, static_cast<uint32_t>(warp * warp_size + lane));
    }
    tracer.end_warp(warp, std::move(recorder));
  }
  tracer.end_dispatch();
  return std::move(tracer.take().front());
}

ShaderInfo shader(const char* name, uint32_t alu, ShaderStage stage) { return {name, stage, {alu, 0}}; }

std::vector<ShaderInfo> free_shader() { return {shader("free", 0)}; }

GpuConfig plain_config() {
  GpuConfig config;
  config.dispatcher.latency = 0;
  config.sm.trace_call_operations = config.sm.shader_call_operations = 0;
  config.rt.fetch_bytes_per_cycle = 256;
  config.rt.accept_bytes_per_cycle = 4096;
  config.l1.line_bytes = 256;
  config.l1.kilobytes = 256;
  config.crossbar.bytes_per_cycle = 1024;
  config.crossbar.latency = 50;
  config.l2.kilobytes_per_slice = 4096;
  config.l2.bytes_per_cycle = 1024;
  config.dram.bandwidth_mb_per_second = 100000000;
  return config;
}

}  // namespace rayloom::hwmodel::test
