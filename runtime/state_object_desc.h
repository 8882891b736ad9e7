#pragma once

// The subobjects of a state object. Names and rules are DXR's (checklist sections 2 and 3); pointers and counted arrays
// are C++ values, so nothing has to outlive the call.

#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/root_signature.h>
#include <rayloom/runtime/shader_library.h>

#include <string>
#include <variant>
#include <vector>

namespace rayloom {

/// Exports one shader of a library, under another name if `ExportToRename` is set (SO-06).
struct EXPORT_DESC {
  std::string Name;
  std::string ExportToRename = {};
};
/// No exports: everything in the library (SO-05).
struct DXIL_LIBRARY_DESC {
  ShaderLibrary Library;
  std::vector<EXPORT_DESC> Exports = {};
};
struct HIT_GROUP_DESC {
  std::string HitGroupExport;
  HIT_GROUP_TYPE Type = HIT_GROUP_TYPE_TRIANGLES;
  std::string AnyHitShaderImport = {};
  std::string ClosestHitShaderImport = {};
  std::string IntersectionShaderImport = {};
};
struct RAYTRACING_SHADER_CONFIG {
  uint32_t MaxPayloadSizeInBytes = 0;
  uint32_t MaxAttributeSizeInBytes = 8;
  friend bool operator==(const RAYTRACING_SHADER_CONFIG&, const RAYTRACING_SHADER_CONFIG&) = default;
};
/// D3D12_RAYTRACING_PIPELINE_CONFIG1; without flags it is the older PIPELINE_CONFIG (SO-19).
struct RAYTRACING_PIPELINE_CONFIG {
  uint32_t MaxTraceRecursionDepth = 1;
  RAYTRACING_PIPELINE_FLAGS Flags = RAYTRACING_PIPELINE_FLAG_NONE;
  friend bool operator==(const RAYTRACING_PIPELINE_CONFIG&, const RAYTRACING_PIPELINE_CONFIG&) = default;
};
struct GLOBAL_ROOT_SIGNATURE {
  RootSignature Signature;
};
struct LOCAL_ROOT_SIGNATURE {
  RootSignature Signature;
};
/// Gives exports a shader config or root signature of this description, named by its index. No exports: the default
/// for every export that has no association of its own (ASC-03).
struct SUBOBJECT_TO_EXPORTS_ASSOCIATION {
  size_t SubobjectToAssociate = 0;
  std::vector<std::string> Exports = {};
};

using STATE_SUBOBJECT =
    std::variant<DXIL_LIBRARY_DESC, HIT_GROUP_DESC, RAYTRACING_SHADER_CONFIG, RAYTRACING_PIPELINE_CONFIG,
                 GLOBAL_ROOT_SIGNATURE, LOCAL_ROOT_SIGNATURE, SUBOBJECT_TO_EXPORTS_ASSOCIATION>;

struct STATE_OBJECT_DESC {
  STATE_OBJECT_TYPE Type = STATE_OBJECT_TYPE_RAYTRACING_PIPELINE;
  std::vector<STATE_SUBOBJECT> Subobjects = {};

  /// Appends a subobject; returns its index for associations.
  size_t add(STATE_SUBOBJECT subobject);
};

}  // namespace rayloom
