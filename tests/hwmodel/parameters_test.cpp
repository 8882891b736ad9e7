#include <rayloom/base/error.h>
#include <rayloom/base/json.h>
#include <rayloom/hwmodel/parameters.h>
#include <rayloom/hwmodel/presets.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

using namespace rayloom;
using namespace rayloom::hwmodel;

TEST_CASE("every preset has one row for every parameter, in range, with a source") {
  for (const PresetDefinition& definition : preset_definitions()) {
    std::map<std::string, int> rows;
    for (const PresetValue& row : definition.values) {
      ++rows[row.key];
      CHECK(std::string(row.source).size() > 3);
    }
    for (const Parameter& parameter : parameters()) {
      INFO(parameter.key);
      CHECK(rows[parameter.key] == 1);
    }
    CHECK(rows.size() == parameters().size());
    CHECK_NOTHROW(check_config(make_preset(definition.name).config));
  }
}

TEST_CASE("parameters have different names and fields") {
  GpuConfig config;
  std::set<std::string> keys;
  std::set<const uint32_t*> fields;
  for (const Parameter& parameter : parameters()) {
    keys.insert(parameter.key);
    fields.insert(&parameter.field(config));
  }
  CHECK(keys.size() == parameters().size());
  CHECK(fields.size() == parameters().size());
}

TEST_CASE("a parameter is set by name and says who set it") {
  GpuPreset preset = make_preset("turing");
  CHECK(preset.config.sm.count == 68);
  set_parameter(preset, "rt.box_latency=13");
  CHECK(preset.config.rt.box_latency == 13);
  const Json json = Json::parse(parameter_json(preset));
  CHECK(json["parameters"]["rt.box_latency"]["value"] == 13);
  CHECK(json["parameters"]["rt.box_latency"]["confidence"] == "user");
  CHECK(json["parameters"]["sm.count"]["confidence"] == "vendor");
  CHECK_THAT(parameter_table(preset), Catch::Contains("rt.box_latency") && Catch::Contains("set by the user"));
}

TEST_CASE("wrong settings are usage errors that help") {
  GpuPreset preset = make_preset("turing");
  CHECK_THROWS_WITH(set_parameter(preset, "rt.box_latncy=3"), Catch::Contains("\"rt.box_latency\""));
  CHECK_THROWS_WITH(set_parameter(preset, "l1.mshr=3"), Catch::Contains("did you mean"));
  CHECK_THROWS_WITH(set_parameter(preset, "sm.count=0"), Catch::Contains("1 to 1024"));
  CHECK_THROWS_WITH(set_parameter(preset, "sm.count=many"), Catch::Contains("no whole number"));
  CHECK_THROWS_WITH(set_parameter(preset, "sm.count=-3"), Catch::Contains("no whole number"));
  CHECK_THROWS_WITH(set_parameter(preset, "sm.count=99999999999999999999999"), Catch::Contains("no whole number"));
  CHECK_THROWS_WITH(set_parameter(preset, "sm.count"), Catch::Contains("key=value"));
  CHECK_THROWS_AS(set_parameter(preset, "=1"), UsageError);
  CHECK_THROWS_WITH(make_preset("voodoo"), Catch::Contains("\"turing\""));
  CHECK(preset.config.sm.count == 68);
}

TEST_CASE("docs/hwmodel.md shows the preset as it is") {
  std::stringstream text;
  text << std::ifstream(RAYLOOM_SOURCE_DIR "/docs/hwmodel.md").rdbuf();
  const GpuPreset preset = make_preset("turing");
  for (size_t i = 0; i < parameters().size(); ++i) {
    const Parameter& parameter = parameters()[i];
    const Provenance& provenance = preset.provenance[i];
    CHECK_THAT(text.str(), Catch::Contains("| `" + std::string(parameter.key) + "` | " +
                                           std::to_string(parameter_value(preset.config, parameter)) + " | " +
                                           parameter.unit + " | " + parameter.meaning + " | " +
                                           confidence_name(provenance.confidence) + " | " + provenance.source + " |"));
  }
}
