#include <rayloom/shaders/pipeline_builder.h>

#include <algorithm>

namespace rayloom::shaders {

std::string PipelineBuilder::triangles(const std::string& group, const std::string& any_hit,
                                       const std::string& closest_hit) {
  groups_.push_back({group, HIT_GROUP_TYPE_TRIANGLES, any_hit, closest_hit, ""});
  triangle_groups_.push_back(group);
  return group;
}

std::string PipelineBuilder::spheres(const std::string& group, const std::string& closest_hit) {
  groups_.push_back({group, HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE, "", closest_hit, "SphereIntersection"});
  sphere_groups_.push_back(group);
  return group;
}

void PipelineBuilder::shadow() {
  miss("ShadowMiss", ShadowMiss{});
  payload_bytes_ = std::max<uint32_t>(payload_bytes_, sizeof(ShadowPayload));
  if (scene_.has(HitKind::masked_triangles)) {
    library_.AnyHit("ShadowAlphaTest", AlphaTest<ShadowPayload>{scene_.view().materials},
                    with_local<TriangleRecord>(cost::alpha));
    names_.shadow[1] = triangles("MaskedShadow", "ShadowAlphaTest", "");
  }
  if (scene_.has(HitKind::spheres)) names_.shadow[2] = spheres("SphereShadow", "");
}

Program PipelineBuilder::build() {
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{std::move(library_)});
  for (const HIT_GROUP_DESC& group : groups_) desc.add(group);
  desc.add(RAYTRACING_SHADER_CONFIG{payload_bytes_, 8});
  desc.add(RAYTRACING_PIPELINE_CONFIG{1});
  desc.add(GLOBAL_ROOT_SIGNATURE{RootSignature().Struct<FilmArguments>()});
  const auto associate = [&](const RootSignature& signature, const std::vector<std::string>& exports) {
    if (!exports.empty())
      desc.add(SUBOBJECT_TO_EXPORTS_ASSOCIATION{desc.add(LOCAL_ROOT_SIGNATURE{signature}), exports});
  };
  associate(RootSignature().Struct<TriangleRecord>(), triangle_groups_);
  associate(RootSignature().Struct<SphereRecord>(), sphere_groups_);

  Program program;
  program.pipeline = device_.CreateStateObject(desc);
  const auto table = [&](const std::vector<std::string>& names) {
    ShaderTableBuilder builder(*program.pipeline);
    for (const std::string& name : names) builder.add(name);
    return builder.build(device_);
  };
  program.ray_generation = table({"RayGeneration"});
  program.miss = table(misses_);
  if (!callables_.empty()) program.callables = table(callables_);
  program.hit_groups = scene_.hit_group_table(*program.pipeline, names_);
  return program;
}

}  // namespace rayloom::shaders
