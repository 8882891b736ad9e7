#include <rayloom/runtime/root_signature.h>
#include <rayloom/runtime/shader_record.h>

#include <algorithm>
#include <limits>

namespace rayloom::detail {
namespace {

constexpr ShaderIdentifier null_identifier{};
/// Records of a table; dispatches of few threads should not wait for large tables.
constexpr uint64_t most_looked_up = 1024;

const char* table_name(ExportKind kind) {
  switch (kind) {
    case ExportKind::ray_generation:
      return "ray generation record";
    case ExportKind::miss:
      return "miss table";
    case ExportKind::callable:
      return "callable table";
    default:
      return "hit group table";
  }
}

}  // namespace

uint64_t RecordTable::locate(const ShaderMemory& memory, uint64_t index) const {
  constexpr uint64_t header = SHADER_IDENTIFIER_SIZE_IN_BYTES;
  const uint64_t offset = range.StrideInBytes * index;  // stride <= 4096 and index < 2^33: no overflow
  if (range.SizeInBytes < header || offset > range.SizeInBytes - header) return 0;
  return memory.host(range.StartAddress + offset, header) ? range.StartAddress + offset : 0;
}

uint32_t RecordTable::local_bytes(uint64_t record_address) const {
  constexpr uint64_t header = SHADER_IDENTIFIER_SIZE_IN_BYTES;
  const uint64_t rest = range.StartAddress + range.SizeInBytes - record_address - header;
  const uint64_t own = range.StrideInBytes ? range.StrideInBytes - header : RootSignature::max_local_bytes;
  return static_cast<uint32_t>(std::min(rest, own));
}

RecordTable::RecordTable(const ShaderMemory& memory, const Pipeline& pipeline,
                         const GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE& table, ExportKind table_kind)
    : range(table), kind(table_kind) {
  if (!locate(memory, 0) || !memory.committed_all(table.StartAddress, table.SizeInBytes)) return;
  host = memory.host(table.StartAddress, SHADER_IDENTIFIER_SIZE_IN_BYTES);
  checked = table.StrideInBytes ? table.SizeInBytes / table.StrideInBytes : std::numeric_limits<uint64_t>::max();
  targets.resize(std::min(checked, table.StrideInBytes ? most_looked_up : 1));
  for (size_t i = 0; i < targets.size(); ++i) {
    const Export* const named = pipeline.find(host + i * table.StrideInBytes);
    if (named && named->kind == kind) targets[i] = named;
  }
}

SelectedRecord select_unusual_record(const Lane& lane, const RecordTable& table, uint64_t index) {
  const ShaderMemory& memory = lane.dispatch().shader_memory;
  const uint64_t address = table.locate(memory, index);
  if (!address) {
    lane.report("ST-18", [&] {
      return "record " + std::to_string(index) + " lies outside of the " + table_name(table.kind) + " of " +
             std::to_string(table.range.SizeInBytes) + " bytes; it counts as NULL";
    });
    return {};
  }
  const std::byte* const identifier = memory.host(address, SHADER_IDENTIFIER_SIZE_IN_BYTES);
  const Export* const target = lane.dispatch().pipeline.find(identifier);
  if (target && target->kind == table.kind) return {target, address};
  if (std::memcmp(identifier, null_identifier.data(), null_identifier.size()) != 0)
    lane.report("ST-19", [&] {
      return "record " + std::to_string(index) + " of the " + table_name(table.kind) +
             " names no such shader of the bound state object; it counts as NULL";
    });
  return {nullptr, address};
}

}  // namespace rayloom::detail
