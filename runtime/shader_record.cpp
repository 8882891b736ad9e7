#include <rayloom/runtime/root_signature.h>
#include <rayloom/runtime/shader_record.h>

#include <algorithm>

namespace rayloom::detail {
namespace {

constexpr ShaderIdentifier null_identifier{};

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

/// Where the record lies; address 0 when it is not all inside the table and committed memory.
ShaderRecord locate(const ShaderMemory& memory, const GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE& table, uint64_t index) {
  constexpr uint64_t header = SHADER_IDENTIFIER_SIZE_IN_BYTES;
  const uint64_t offset = table.StrideInBytes * index;  // stride <= 4096 and index < 2^33: no overflow
  if (table.SizeInBytes < header || offset > table.SizeInBytes - header) return {};
  if (!memory.host(table.StartAddress + offset, header)) return {};
  const uint64_t rest = table.SizeInBytes - offset - header;
  const uint64_t own = table.StrideInBytes ? table.StrideInBytes - header : RootSignature::max_local_bytes;
  return {table.StartAddress + offset, static_cast<uint32_t>(std::min(rest, own))};
}

}  // namespace

SelectedRecord select_record(const Lane& lane, const GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE& table, uint64_t index,
                             ExportKind kind) {
  const ShaderMemory& memory = lane.dispatch().shader_memory;
  const ShaderRecord record = locate(memory, table, index);
  if (!record.address) {
    lane.report("ST-18", [&] {
      return "record " + std::to_string(index) + " lies outside of the " + table_name(kind) + " of " +
             std::to_string(table.SizeInBytes) + " bytes; it counts as NULL";
    });
    return {};
  }
  const std::byte* const identifier = memory.host(record.address, SHADER_IDENTIFIER_SIZE_IN_BYTES);
  const Export* const target = lane.dispatch().pipeline.find(identifier);
  if (target && target->kind == kind) return {target, record};
  if (std::memcmp(identifier, null_identifier.data(), null_identifier.size()) != 0)
    lane.report("ST-19", [&] {
      return "record " + std::to_string(index) + " of the " + table_name(kind) +
             " names no such shader of the bound state object; it counts as NULL";
    });
  return {nullptr, record};
}

}  // namespace rayloom::detail
