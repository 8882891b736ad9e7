#include <rayloom/accel/checks.h>
#include <rayloom/accel/instance_leaf.h>
#include <rayloom/accel/refit.h>
#include <rayloom/accel/structure.h>
#include <rayloom/base/error.h>

#include <string>

namespace rayloom::accel {
namespace {

[[noreturn]] void fail(const char* object, const std::string& rule) {
  throw InputError("acceleration structure update", object, rule);
}

void check_same(const char* object, uint64_t source, uint64_t update, const char* row) {
  if (source == update) return;
  fail(object, "the source was built with " + std::to_string(source) + ", the update has " + std::to_string(update) +
                   " (" + row + ")");
}

bool overlap_partly(const std::byte* source, const std::byte* result, uint64_t bytes) {
  const std::less<> before;
  return source != result && before(source, result + bytes) && before(result, source + bytes);
}

/// Flags may lose ALLOW_UPDATE and, by our reading of Q-07, ALLOW_COMPACTION.
void check_flags(uint32_t source, uint32_t update) {
  if (!(source & build_flag::allow_update)) fail("source", "was built without ALLOW_UPDATE (BF-01)");
  constexpr uint32_t may_go = build_flag::allow_update | build_flag::allow_compaction;
  if (update & ~source & may_go) fail("build flags", "ALLOW_COMPACTION cannot be added by an update (BF-02)");
  if ((source | may_go) != (update | may_go)) fail("build flags", "differ from the source's (BF-06)");
}

}  // namespace

void check_update(const std::byte* source, std::span<const std::byte> result, StructureKind kind, uint64_t primitives,
                  uint64_t geometries, const BuildSettings& settings) {
  const StructureHeader& header = checked_header(source, "source");
  if (header.kind != kind) fail("source", "holds another kind of primitives (UP-02)");
  check_same("primitives", header.primitive_count, primitives, kind == StructureKind::instances ? "UP-05" : "UP-02");
  check_same("geometries", header.geometry_count, geometries, "UP-02");
  check_flags(header.build_flags, settings.flags);
  check_result(result, header.bytes);
  if (overlap_partly(source, result.data(), header.bytes)) fail("result", "overlaps the source (UP-01)");
}

StructureHeader begin_update(const std::byte* source, std::byte* result, const BuildSettings& settings) {
  StructureHeader header = header_of(source);
  if (source != result) std::memcpy(result, source, header.bytes);
  header.build_flags = settings.flags;
  header.root = root_of(header);
  header.lazy_root = 0;
  return header;
}

uint64_t end_update(const Refitted& root, StructureHeader header, std::byte* result) {
  for (int k = 0; k < 3; ++k) {
    header.bounds_min[k] = root.bounds.empty() ? 0 : root.bounds.min[k] + 0.0f;
    header.bounds_max[k] = root.bounds.empty() ? 0 : root.bounds.max[k] + 0.0f;
  }
  const double area = root.bounds.half_area();
  header.sah_cost = area > 0 ? root.area_sum / area : static_cast<double>(header.node_count) + header.leaf_count;
  if (header.kind == StructureKind::instances) header.pad_scale = pad_scale_for(root.conditioning);
  std::memcpy(result, &header, sizeof(header));
  return header.bytes;
}

}  // namespace rayloom::accel
