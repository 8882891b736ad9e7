#pragma once

// The shader tables of a running dispatch. They are checked once: a record inside of the checked part is found with a
// multiplication and an addition.

#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/shader_memory.h>

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
  const std::byte* host = nullptr;  ///< of record 0
  const Export* first = nullptr;    ///< what record 0 names; null where select_record() must find out
  uint64_t checked = 0;             ///< how many records from the first are known to lie in committed memory
};

}  // namespace rayloom::detail
