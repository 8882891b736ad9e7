#pragma once

// Shader tables are raw bytes: finds a record by index and the shader its identifier names.

#include <rayloom/runtime/lane.h>

namespace rayloom::detail {

struct SelectedRecord {
  const Export* target = nullptr;  ///< null: the NULL identifier, or nothing that could run (ST-14..16, ST-18, ST-19)
  uint64_t address = 0;            ///< of the record
};

/// The index of ST-07 with the maskings of ST-08. At most 2^28 - 1 for legal input, computed in 64 bits (ST-12).
constexpr uint64_t hit_group_index(uint32_t ray_contribution, uint32_t geometry_multiplier, uint32_t geometry_index,
                                   uint32_t instance_contribution) {
  return uint64_t{ray_contribution & 0xFu} + uint64_t{geometry_multiplier & 0xFu} * geometry_index +
         (instance_contribution & 0xFFFFFFu);
}

/// Everything select_record() has to say about records that name no shader of the right kind.
SelectedRecord select_unusual_record(const Lane& lane, const RecordTable& table, uint64_t index);

/// A record must name an export of the table's kind; anything else counts as NULL and is reported.
inline SelectedRecord select_record(const Lane& lane, const RecordTable& table, uint64_t index) {
  const uint64_t offset = index * table.range.StrideInBytes;
  const Export* target = nullptr;
  if (index < table.targets.size()) [[likely]] {
    target = table.targets[index];
  } else if (index < table.checked) {
    const Export* const named = lane.dispatch().pipeline.find(table.host + offset);
    if (named && named->kind == table.kind) target = named;
  }
  if (target) [[likely]]
    return {target, table.range.StartAddress + offset};
  return select_unusual_record(lane, table, index);
}

}  // namespace rayloom::detail
