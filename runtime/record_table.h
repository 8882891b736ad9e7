#pragma once

// The shader tables of a running dispatch. They are checked once, and what the first of their records name is looked up
// (DR-08: tables are read when the command executes).

#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/shader_memory.h>

#include <vector>

namespace rayloom::detail {

struct RecordTable {
  RecordTable(const ShaderMemory& memory, const Pipeline& pipeline, const GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE& table,
              ExportKind table_kind);

  /// Address of a record; 0 when its identifier is not all inside the table and committed memory.
  uint64_t locate(const ShaderMemory& memory, uint64_t index) const;
  /// What a shader may read after the identifier of a record that locate() gave.
  uint32_t local_bytes(uint64_t record_address) const;

  GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE range;
  ExportKind kind;
  const std::byte* host = nullptr;     ///< of record 0
  uint64_t checked = 0;                ///< how many records from the first are known to lie in committed memory
  std::vector<const Export*> targets;  ///< of the first checked records: what they name, null where it is unusual
};

}  // namespace rayloom::detail
