#include <rayloom/base/error.h>
#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/root_association.h>

#include <algorithm>
#include <optional>
#include <set>

namespace rayloom::detail {

void fail_creation(const std::string& subobject, std::string_view row, const std::string& rule) {
  throw InputError("state object", subobject, rule + " [" + std::string(row) + "]");
}

namespace {

const char* stage_name(ShaderStage stage) {
  switch (stage) {
    case ShaderStage::ray_generation:
      return "a ray generation shader";
    case ShaderStage::intersection:
      return "an intersection shader";
    case ShaderStage::any_hit:
      return "an any-hit shader";
    case ShaderStage::closest_hit:
      return "a closest-hit shader";
    case ShaderStage::miss:
      return "a miss shader";
    default:
      return "a callable shader";
  }
}

/// What a record may select by the shader's own name; parts of hit groups have no identifier (SID-03).
std::optional<ExportKind> export_kind(ShaderStage stage) {
  switch (stage) {
    case ShaderStage::ray_generation:
      return ExportKind::ray_generation;
    case ShaderStage::miss:
      return ExportKind::miss;
    case ShaderStage::callable:
      return ExportKind::callable;
    default:
      return std::nullopt;
  }
}

/// Turns the subobjects of one description into a pipeline, rule by rule.
class Resolver {
 public:
  explicit Resolver(const STATE_OBJECT_DESC& desc)
      : desc_(desc),
        global_(RootAssociations::collect<GLOBAL_ROOT_SIGNATURE>(desc, "global root signature")),
        local_(RootAssociations::collect<LOCAL_ROOT_SIGNATURE>(desc, "local root signature")) {}

  Pipeline resolve() {
    if (desc_.Type != STATE_OBJECT_TYPE_RAYTRACING_PIPELINE)
      fail_creation("type", "SO-01", "only raytracing pipelines can be created by this version");
    each<DXIL_LIBRARY_DESC>([&](const auto& library) { add_library(library); });
    each<HIT_GROUP_DESC>([&](const auto& group) { add_hit_group(group); });
    take_configs();
    check_associations();
    check_sizes();
    check_local_signatures();
    check_roots();
    add_exports();
    return std::move(pipeline_);
  }

 private:
  template <class Subobject, class Visit>
  void each(Visit visit) const {
    for (const STATE_SUBOBJECT& subobject : desc_.Subobjects)
      if (const auto* item = std::get_if<Subobject>(&subobject)) visit(*item);
  }

  void claim(const std::string& name, const char* what) {
    if (name.empty()) fail_creation(what, "SO-06", "has no export name");
    if (!names_.insert(name).second)
      fail_creation(std::string(what) + " '" + name + "'", "SO-08", "is a name that is already taken");
  }

  void add_shader(const ShaderDefinition& shader, const std::string& name) {
    claim(name, "shader");
    pipeline_.shaders.push_back(shader);
    pipeline_.shaders.back().name = name;
    pipeline_.infos.push_back({name, shader.stage, shader.options.cost});
    pipeline_.code.push_back(
        {shader.entry, shader.functor.get(), shader.payload, shader.attributes, shader.stack_bytes(), shader.stage});
  }

  void add_library(const DXIL_LIBRARY_DESC& library) {
    const auto& shaders = library.Library.shaders();
    if (library.Exports.empty())
      for (const ShaderDefinition& shader : shaders) add_shader(shader, shader.name);
    for (const EXPORT_DESC& item : library.Exports) {
      const std::string& source = item.ExportToRename.empty() ? item.Name : item.ExportToRename;
      const auto found = std::find_if(shaders.begin(), shaders.end(), [&](auto& s) { return s.name == source; });
      if (found == shaders.end()) fail_creation("export '" + source + "'", "SO-05", "is not in its library");
      add_shader(*found, item.Name);
    }
  }

  uint32_t import_shader(const std::string& group, const std::string& name, ShaderStage stage) const {
    if (name.empty()) return no_shader;
    const auto found = std::find_if(pipeline_.shaders.begin(), pipeline_.shaders.end(),
                                    [&](auto& shader) { return shader.name == name; });
    if (found == pipeline_.shaders.end() || found->stage != stage)
      fail_creation(group, "SO-13", "imports '" + name + "', which is not " + stage_name(stage));
    return static_cast<uint32_t>(found - pipeline_.shaders.begin());
  }

  void add_hit_group(const HIT_GROUP_DESC& desc) {
    claim(desc.HitGroupExport, "hit group");
    const std::string object = "hit group '" + desc.HitGroupExport + "'";
    const bool procedural = desc.Type == HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE;
    if (procedural == desc.IntersectionShaderImport.empty())
      fail_creation(object, "SO-11",
                    procedural ? "is procedural and has no intersection shader"
                               : "is for triangles and has an intersection shader");
    HitGroup group{desc.HitGroupExport, desc.Type};
    group.any_hit = import_shader(object, desc.AnyHitShaderImport, ShaderStage::any_hit);
    group.closest_hit = import_shader(object, desc.ClosestHitShaderImport, ShaderStage::closest_hit);
    group.intersection = import_shader(object, desc.IntersectionShaderImport, ShaderStage::intersection);
    check_attributes(group, object);
    pipeline_.decides_candidates |= group.any_hit != no_shader || procedural;
    pipeline_.hit_groups.push_back(std::move(group));
  }

  /// Triangles give barycentrics; both shaders of a procedural group take what its intersection shader reports
  /// (STG-12).
  void check_attributes(const HitGroup& group, const std::string& object) const {
    const ShaderDefinition* any_hit = pipeline_.shader(group.any_hit);
    const ShaderDefinition* closest_hit = pipeline_.shader(group.closest_hit);
    if (any_hit && closest_hit && !(any_hit->attributes == closest_hit->attributes))
      fail_creation(object, "STG-12", "its any-hit and closest-hit shaders take different attributes");
    for (const ShaderDefinition* shader : {any_hit, closest_hit})
      if (shader && group.type == HIT_GROUP_TYPE_TRIANGLES &&
          !(shader->attributes == type_info_of<BuiltInTriangleIntersectionAttributes>()))
        fail_creation(object, "STG-12", "'" + shader->name + "' does not take BuiltInTriangleIntersectionAttributes");
  }

  template <class Config>
  void take_one(Config& result, const char* what, const char* row) const {
    bool found = false;
    each<Config>([&](const Config& config) {
      if (found && config != result) fail_creation(what, row, "two different ones are given");
      found = true;
      result = config;
    });
    if (!found) fail_creation(what, row, "is missing");
  }

  void take_configs() {
    take_one(pipeline_.shader_config, "shader config", "SO-14");
    take_one(pipeline_.config, "pipeline config", "SO-17");
    const auto& config = pipeline_.config;
    if (config.MaxTraceRecursionDepth > RAYTRACING_MAX_DECLARABLE_TRACE_RECURSION_DEPTH)
      fail_creation("pipeline config", "SO-18",
                    "MaxTraceRecursionDepth " + std::to_string(config.MaxTraceRecursionDepth) + " is above 31");
    const uint32_t both = RAYTRACING_PIPELINE_FLAG_SKIP_TRIANGLES | RAYTRACING_PIPELINE_FLAG_SKIP_PROCEDURAL_PRIMITIVES;
    if (config.Flags & ~both) fail_creation("pipeline config", "SO-19", "has flags this version does not know");
    if (config.Flags == both) fail_creation("pipeline config", "RF-14", "skips triangles and procedural primitives");
    if (pipeline_.shader_config.MaxAttributeSizeInBytes > RAYTRACING_MAX_ATTRIBUTE_SIZE_IN_BYTES)
      fail_creation("shader config", "SO-16", "MaxAttributeSizeInBytes is above 32");
  }

  void check_associations() const {
    each<SUBOBJECT_TO_EXPORTS_ASSOCIATION>([&](const auto& association) {
      const size_t target = association.SubobjectToAssociate;
      if (target >= desc_.Subobjects.size() || !can_be_associated(desc_.Subobjects[target]))
        fail_creation("association", "ASC-06", "subobject " + std::to_string(target) + " cannot be associated");
      for (const std::string& name : association.Exports)
        if (!names_.count(name)) fail_creation("association", "ASC-07", "names the unknown export '" + name + "'");
    });
  }
  static bool can_be_associated(const STATE_SUBOBJECT& subobject) {
    return std::holds_alternative<RAYTRACING_SHADER_CONFIG>(subobject) ||
           std::holds_alternative<RAYTRACING_PIPELINE_CONFIG>(subobject) ||
           std::holds_alternative<GLOBAL_ROOT_SIGNATURE>(subobject) ||
           std::holds_alternative<LOCAL_ROOT_SIGNATURE>(subobject);
  }

  void check_sizes() const {
    const RAYTRACING_SHADER_CONFIG& config = pipeline_.shader_config;
    for (const ShaderDefinition& shader : pipeline_.shaders) {
      const std::string object = "shader '" + shader.name + "'";
      if (shader.stage != ShaderStage::callable && shader.payload.bytes > config.MaxPayloadSizeInBytes)
        fail_creation(object, "SO-15",
                      "its payload of " + std::to_string(shader.payload.bytes) +
                          " bytes exceeds MaxPayloadSizeInBytes " + std::to_string(config.MaxPayloadSizeInBytes));
      if (shader.attributes.bytes > config.MaxAttributeSizeInBytes)
        fail_creation(object, "SO-16",
                      "its attributes of " + std::to_string(shader.attributes.bytes) +
                          " bytes exceed MaxAttributeSizeInBytes " + std::to_string(config.MaxAttributeSizeInBytes));
    }
    for (const HitGroup& group : pipeline_.hit_groups)
      if (group.type == HIT_GROUP_TYPE_TRIANGLES && config.MaxAttributeSizeInBytes < 8)
        fail_creation("hit group '" + group.name + "'", "SO-16", "triangles need MaxAttributeSizeInBytes 8");
  }

  /// The one local root signature of a hit group: the group's own association, else its shaders', which must agree.
  const RootSignature* group_signature(const HitGroup& group) const {
    const RootSignature* const own = local_.explicit_for(group.name);
    const RootSignature* common = own;
    bool first = !own;
    for (const uint32_t index : {group.any_hit, group.closest_hit, group.intersection}) {
      if (index == no_shader) continue;
      const std::string& name = pipeline_.shaders[index].name;
      const RootSignature* const signature = own ? local_.explicit_for(name) : local_.effective(name);
      if (own && !signature) continue;
      if (!first && !same(common, signature))
        fail_creation("hit group '" + group.name + "'", "ASC-12", "its shaders have different local root signatures");
      common = signature;
      first = false;
    }
    return first ? local_.default_signature() : common;
  }
  static bool same(const RootSignature* a, const RootSignature* b) { return a == b || (a && b && *a == *b); }

  void check_local_signatures() const {
    each<LOCAL_ROOT_SIGNATURE>([](const auto& local) {
      if (local.Signature.bytes() > RootSignature::max_local_bytes)
        fail_creation("local root signature", "RS-06", "takes more than 4064 bytes");
    });
  }

  void check_root(const ShaderDefinition& shader, const TypeInfo& wanted, const RootSignature* signature,
                  const char* kind) const {
    const uint32_t given = bytes_of(signature);
    if (wanted && wanted.bytes > given)
      fail_creation("shader '" + shader.name + "'", "SO-25",
                    std::string("reads ") + std::to_string(wanted.bytes) + " bytes of " + kind +
                        " root arguments, its root signature gives " + std::to_string(given));
  }

  void check_roots() const {
    for (const ShaderDefinition& shader : pipeline_.shaders) {
      check_root(shader, shader.options.global_root, global_.effective(shader.name), "global");
      if (export_kind(shader.stage))
        check_root(shader, shader.options.local_root, local_.effective(shader.name), "local");
    }
    for (const HitGroup& group : pipeline_.hit_groups)
      for (const uint32_t index : {group.any_hit, group.closest_hit, group.intersection})
        if (index != no_shader)
          check_root(pipeline_.shaders[index], pipeline_.shaders[index].options.local_root, group_signature(group),
                     "local");
  }

  static uint32_t bytes_of(const RootSignature* signature) { return signature ? signature->bytes() : 0; }

  void add_exports() {
    for (size_t i = 0; i < pipeline_.shaders.size(); ++i) {
      const ShaderDefinition& shader = pipeline_.shaders[i];
      if (const auto kind = export_kind(shader.stage))
        pipeline_.add_export(shader.name, *kind, i, bytes_of(local_.effective(shader.name)));
    }
    for (size_t i = 0; i < pipeline_.hit_groups.size(); ++i) {
      const HitGroup& group = pipeline_.hit_groups[i];
      pipeline_.add_export(group.name, ExportKind::hit_group, i, bytes_of(group_signature(group)));
    }
  }

  const STATE_OBJECT_DESC& desc_;
  RootAssociations global_, local_;
  std::set<std::string> names_;
  Pipeline pipeline_;
};

}  // namespace

Pipeline resolve_pipeline(const STATE_OBJECT_DESC& desc) { return Resolver(desc).resolve(); }

}  // namespace rayloom::detail
