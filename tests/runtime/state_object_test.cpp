// Rows SO, ASC, SID: subobjects, associations, identifiers and stack sizes.

#include "program.h"

#include <rayloom/base/error.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;
using Catch::Matchers::Contains;

namespace {

struct WideAttributes {
  float value[8];
};

ShaderLibrary all_stages() {
  ShaderLibrary library;
  library.RayGeneration("rg", [](RayGenContext&) {});
  library.Miss("ms", [](MissContext&, Value&) {});
  library.Callable("ca", [](CallableContext&, Value&) {});
  library.ClosestHit("ch", [](ClosestHitContext&, Value&, const Barycentrics&) {});
  library.AnyHit("ah", [](AnyHitContext& ctx, Value&, const Barycentrics&) { return ctx.AcceptHit(); });
  library.Intersection("is", [](IntersectionContext& ctx) { return ctx.EndIntersection(); });
  return library;
}

STATE_OBJECT_DESC base(ShaderLibrary library = all_stages()) {
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{std::move(library)});
  desc.add(RAYTRACING_SHADER_CONFIG{4, 8});
  desc.add(RAYTRACING_PIPELINE_CONFIG{1});
  return desc;
}

void check_refused(const STATE_OBJECT_DESC& desc, const std::string& row) {
  CHECK_THROWS_WITH(StateObject(desc), Contains("[" + row + "]"));
}

STATE_OBJECT_DESC with(STATE_SUBOBJECT subobject) {
  STATE_OBJECT_DESC desc = base();
  desc.add(std::move(subobject));
  return desc;
}

HIT_GROUP_DESC triangles(std::string any_hit, std::string closest_hit, std::string intersection = "") {
  return {"hg", HIT_GROUP_TYPE_TRIANGLES, std::move(any_hit), std::move(closest_hit), std::move(intersection)};
}
HIT_GROUP_DESC procedural(std::string any_hit, std::string closest_hit, std::string intersection) {
  return {"hg", HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE, std::move(any_hit), std::move(closest_hit),
          std::move(intersection)};
}

struct TwoWords {
  uint a, b;
};

}  // namespace

TEST_CASE("SO-01: only raytracing pipelines") {
  STATE_OBJECT_DESC desc = base();
  desc.Type = STATE_OBJECT_TYPE_COLLECTION;
  check_refused(desc, "SO-01");
}

TEST_CASE("SO-05, SO-06, SO-08: export lists filter, rename and collide") {
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{all_stages(), {{"rg"}, {"first", "ms"}, {"second", "ms"}}});
  desc.add(RAYTRACING_SHADER_CONFIG{4, 8});
  desc.add(RAYTRACING_PIPELINE_CONFIG{1});
  const StateObject object(desc);
  CHECK(object.GetShaderIdentifier("rg"));
  CHECK(object.GetShaderIdentifier("first"));
  CHECK(object.GetShaderIdentifier("second"));
  CHECK_FALSE(object.GetShaderIdentifier("ms"));
  CHECK_FALSE(object.GetShaderIdentifier("ca"));
  check_refused(with(DXIL_LIBRARY_DESC{all_stages(), {{"ms"}}}), "SO-08");
  check_refused(with(DXIL_LIBRARY_DESC{all_stages(), {{"nothing"}}}), "SO-05");
  CHECK_NOTHROW(StateObject(with(DXIL_LIBRARY_DESC{all_stages(), {{"other", "ms"}}})));
}

TEST_CASE("SO-10, SO-12: all eight kinds of hit groups") {
  for (const std::string any_hit : {"", "ah"})
    for (const std::string closest_hit : {"", "ch"}) {
      CHECK_NOTHROW(StateObject(with(triangles(any_hit, closest_hit))));
      CHECK_NOTHROW(StateObject(with(procedural(any_hit, closest_hit, "is"))));
    }
}

TEST_CASE("SO-11, SO-13: wrong hit groups") {
  check_refused(with(triangles("", "ch", "is")), "SO-11");
  check_refused(with(procedural("", "ch", "")), "SO-11");
  check_refused(with(triangles("ch", "")), "SO-13");
  check_refused(with(triangles("", "ah")), "SO-13");
  check_refused(with(triangles("", "nobody")), "SO-13");
  check_refused(with(procedural("", "", "ah")), "SO-13");
  STATE_OBJECT_DESC twice = with(triangles("", "ch"));
  twice.add(triangles("", "ch"));
  check_refused(twice, "SO-08");
}

TEST_CASE("SO-14, SO-17: one effective config of each kind") {
  STATE_OBJECT_DESC empty;
  empty.add(DXIL_LIBRARY_DESC{all_stages()});
  check_refused(empty, "SO-14");
  empty.add(RAYTRACING_SHADER_CONFIG{4, 8});
  check_refused(empty, "SO-17");
  CHECK_NOTHROW(StateObject(with(RAYTRACING_SHADER_CONFIG{4, 8})));
  CHECK_NOTHROW(StateObject(with(RAYTRACING_PIPELINE_CONFIG{1})));
  check_refused(with(RAYTRACING_SHADER_CONFIG{8, 8}), "SO-14");
  check_refused(with(RAYTRACING_PIPELINE_CONFIG{2}), "SO-17");
}

TEST_CASE("SO-15, SO-16, SO-18, SO-19, RF-14: limits of the configs") {
  const auto configured = [](RAYTRACING_SHADER_CONFIG shader, RAYTRACING_PIPELINE_CONFIG pipeline) {
    STATE_OBJECT_DESC desc;
    desc.add(DXIL_LIBRARY_DESC{all_stages()});
    desc.add(triangles("", "ch"));
    desc.add(shader);
    desc.add(pipeline);
    return desc;
  };
  CHECK_NOTHROW(StateObject(configured({4, 32}, {31})));
  check_refused(configured({3, 8}, {1}), "SO-15");
  check_refused(configured({4, 36}, {1}), "SO-16");
  check_refused(configured({4, 4}, {1}), "SO-16");
  check_refused(configured({4, 8}, {32}), "SO-18");
  check_refused(configured({4, 8}, {1, RAYTRACING_PIPELINE_FLAGS(0x400)}), "SO-19");
  check_refused(configured({4, 8}, {1, RAYTRACING_PIPELINE_FLAGS(0x300)}), "RF-14");
}

TEST_CASE("STG-12: attributes of a hit group's shaders") {
  ShaderLibrary library = all_stages();
  library.ClosestHit("other", [](ClosestHitContext&, Value&, const Value&) {});
  STATE_OBJECT_DESC desc = base(library);
  desc.add(triangles("", "other"));
  check_refused(desc, "STG-12");
  desc = base(library);
  desc.add(procedural("ah", "other", "is"));
  check_refused(desc, "STG-12");
  desc = base(library);
  desc.add(procedural("", "other", "is"));
  CHECK_NOTHROW(StateObject(desc));
  library.ClosestHit("wide", [](ClosestHitContext&, Value&, const WideAttributes&) {});
  check_refused(base(library), "SO-16");
}

TEST_CASE("ASC-02, ASC-03, RW-04, ASC-16: default local root signatures") {
  STATE_OBJECT_DESC desc = with(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1)});
  CHECK(StateObject(desc).local_root_bytes("ms") == 4);
  STATE_OBJECT_DESC two = desc;
  const size_t second = two.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(2)});
  check_refused(two, "ASC-16");
  STATE_OBJECT_DESC explicit_default = two;
  explicit_default.add(SUBOBJECT_TO_EXPORTS_ASSOCIATION{second});
  CHECK(StateObject(explicit_default).local_root_bytes("ms") == 8);
  STATE_OBJECT_DESC named = two;
  named.add(SUBOBJECT_TO_EXPORTS_ASSOCIATION{second, {"rg"}});
  const StateObject object(named);
  CHECK(object.local_root_bytes("rg") == 8);
  CHECK(object.local_root_bytes("ms") == 4);
}

TEST_CASE("ASC-06, ASC-07, ASC-09: wrong associations") {
  STATE_OBJECT_DESC desc = base();
  const size_t a = desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1)});
  const size_t b = desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(2)});
  const auto associated = [&](std::vector<SUBOBJECT_TO_EXPORTS_ASSOCIATION> associations) {
    STATE_OBJECT_DESC result = desc;
    for (auto& association : associations) result.add(association);
    return result;
  };
  CHECK_NOTHROW(StateObject(associated({{a, {"ms"}}, {a, {"ms"}}, {b, {"rg"}}})));
  check_refused(associated({{a, {"ms"}}, {b, {"ms"}}}), "ASC-09");
  check_refused(associated({{a, {"nobody"}}, {b, {"ms"}}}), "ASC-07");
  check_refused(associated({{0, {"ms"}}, {a, {"ms"}}, {b, {"rg"}}}), "ASC-06");
  check_refused(associated({{99, {"ms"}}, {a, {"ms"}}, {b, {"rg"}}}), "ASC-06");
}

TEST_CASE("ASC-12: one local root signature a hit group") {
  STATE_OBJECT_DESC desc = with(triangles("ah", "ch"));
  const size_t a = desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1)});
  const size_t b = desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(2)});
  const auto bytes = [&](std::vector<SUBOBJECT_TO_EXPORTS_ASSOCIATION> associations) {
    STATE_OBJECT_DESC result = desc;
    for (auto& association : associations) result.add(association);
    return StateObject(result).local_root_bytes("hg");
  };
  CHECK(bytes({{a, {"hg"}}, {b, {"ms"}}}) == 4);
  CHECK(bytes({{a, {"ah", "ch"}}, {b, {"ms"}}}) == 4);
  CHECK(bytes({{a, {"hg", "ah"}}, {b, {"ms"}}}) == 4);
  CHECK_THROWS_WITH(bytes({{a, {"ah"}}, {b, {"ch"}}}), Contains("[ASC-12]"));
  CHECK_THROWS_WITH(bytes({{a, {"hg"}}, {b, {"ch"}}}), Contains("[ASC-12]"));
  CHECK_THROWS_WITH(bytes({{a, {"ah"}}, {b, {"ms"}}}), Contains("[ASC-12]"));  // closest-hit has none
}

TEST_CASE("SO-25, RS-06: root arguments a shader reads must be in its signature") {
  ShaderLibrary library;
  library.Miss("local", [](MissContext&, Value&) {}, {.local_root = root_type<TwoWords>()});
  check_refused(base(library), "SO-25");
  STATE_OBJECT_DESC desc = base(library);
  desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1)});
  check_refused(desc, "SO-25");
  desc = base(library);
  desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Struct<TwoWords>()});
  CHECK_NOTHROW(StateObject(desc));
  ShaderLibrary global;
  global.RayGeneration("global", [](RayGenContext&) {}, {.global_root = root_type<TwoWords>()});
  check_refused(base(global), "SO-25");
  CHECK_NOTHROW(StateObject(with(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1016)})));
  check_refused(with(LOCAL_ROOT_SIGNATURE{RootSignature().Constants(1017)}), "RS-06");
}

TEST_CASE("RS-04: root arguments lie in order, aligned to their own size") {
  const RootSignature signature = RootSignature().Constants(1).ConstantBufferView().Constants(1).DescriptorTable();
  std::vector<uint> offsets;
  for (const RootParameter& parameter : signature.parameters()) offsets.push_back(32 + parameter.offset);
  CHECK(offsets == std::vector<uint>{32, 40, 48, 56});
  CHECK(signature.bytes() == 32);
}

TEST_CASE("SID-01..SID-07: identifiers") {
  const StateObject object(with(triangles("ah", "ch")));
  const ShaderIdentifier null{};
  std::vector<ShaderIdentifier> seen;
  for (const char* name : {"rg", "ms", "ca", "hg"}) {
    const ShaderIdentifier* const identifier = object.GetShaderIdentifier(name);
    REQUIRE(identifier);
    CHECK(*identifier != null);
    CHECK(std::find(seen.begin(), seen.end(), *identifier) == seen.end());
    CHECK(identifier == object.GetShaderIdentifier(name));
    seen.push_back(*identifier);
  }
  for (const char* name : {"ch", "ah", "is", "nobody", ""}) CHECK_FALSE(object.GetShaderIdentifier(name));
}

TEST_CASE("SID-08..SID-13: stack sizes") {
  ShaderLibrary library;
  library.RayGeneration("rg", [](RayGenContext&) {}, {.stack_bytes = 100});
  library.Miss("ms", [](MissContext&, Value&) {}, {.stack_bytes = 300});
  library.Callable("ca", [](CallableContext&, Value&) {}, {.stack_bytes = 50});
  library.ClosestHit("ch", [](ClosestHitContext&, Value&, const Barycentrics&) {}, {.stack_bytes = 200});
  library.AnyHit("ah", [](AnyHitContext& ctx, Value&, const Barycentrics&) { return ctx.AcceptHit(); },
                 {.stack_bytes = 250});
  library.Intersection("is", [](IntersectionContext& ctx) { return ctx.EndIntersection(); }, {.stack_bytes = 80});
  const auto stack = [&](uint depth) {
    STATE_OBJECT_DESC desc;
    desc.add(DXIL_LIBRARY_DESC{library});
    desc.add(procedural("ah", "ch", "is"));
    desc.add(RAYTRACING_SHADER_CONFIG{4, 8});
    desc.add(RAYTRACING_PIPELINE_CONFIG{depth});
    return std::make_unique<StateObject>(desc);
  };
  CHECK(stack(0)->GetPipelineStackSize() == 100 + 2 * 50);
  CHECK(stack(1)->GetPipelineStackSize() == 100 + (80 + 250) + 2 * 50);
  CHECK(stack(3)->GetPipelineStackSize() == 100 + (80 + 250) + 2 * 300 + 2 * 50);
  const auto object = stack(1);
  CHECK(object->GetShaderStackSize("rg") == 100);
  CHECK(object->GetShaderStackSize("hg::closesthit") == 200);
  CHECK(object->GetShaderStackSize("hg::anyhit") == 250);
  CHECK(object->GetShaderStackSize("hg::intersection") == 80);
  for (const char* name : {"hg", "ch", "hg::ClosestHit", "ms::anyhit", "nobody", "::anyhit"})
    CHECK(object->GetShaderStackSize(name) == 0xffffffff);
  object->SetPipelineStackSize(12345);
  CHECK(object->GetPipelineStackSize() == 12345);
  object->SetPipelineStackSize(0xffffffff);
  object->SetPipelineStackSize(~uint64_t{0});
  CHECK(object->GetPipelineStackSize() == 12345);
  object->SetPipelineStackSize(0xfffffffe);  // RC-07
  CHECK(object->GetPipelineStackSize() == 0xfffffffe);
}

TEST_CASE("an undeclared stack size is estimated from the structs alone (SID-10)") {
  const StateObject object(with(triangles("", "ch")));
  CHECK(object.GetShaderStackSize("rg") == 128);
  CHECK(object.GetShaderStackSize("ms") == 128 + sizeof(Value));
  CHECK(object.GetShaderStackSize("hg::closesthit") == 128 + sizeof(Value) + sizeof(Barycentrics));
}
