#include <rayloom/base/csv.h>
#include <rayloom/base/error.h>
#include <rayloom/base/json.h>
#include <rayloom/base/version.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

using namespace rayloom;

TEST_CASE("a JSON document says what it is and keeps the order of its keys", "[json]") {
  Json document = json_document("rayloom.test", 3);
  document["zebra"] = 1;
  document["apple"] = 2.5;
  CHECK(json_text(document) ==
        "{\n  \"schema\": \"rayloom.test\",\n  \"schema_version\": 3,\n  \"rayloom_version\": \"" +
            std::string(version().number) + "\",\n  \"zebra\": 1,\n  \"apple\": 2.5\n}\n");
}

TEST_CASE("JSON text survives any bytes and numbers", "[json]") {
  const std::string text = json_text({{"name", "\xff.gltf"}, {"nan", std::nan("")}});
  CHECK(text == "{\n  \"name\": \"\xEF\xBF\xBD.gltf\",\n  \"nan\": null\n}\n");
}

TEST_CASE("JSON numbers read back as the same values", "[json]") {
  for (const double value : {0.1, 1.0 / 3.0, 1e300, std::numeric_limits<double>::denorm_min()}) {
    CHECK(Json::parse(json_text(Json(value))).get<double>() == value);
  }
  CHECK(Json::parse(json_text(Json(UINT64_MAX))).get<uint64_t>() == UINT64_MAX);
}

TEST_CASE("JSON that cannot be written is an input error naming the file", "[json]") {
  CHECK_THROWS_AS(write_json("/nonexistent/stats.json", json_document("rayloom.test", 1)), InputError);
  CHECK_THROWS_WITH(write_json("/nonexistent/stats.json", Json()), Catch::Contains("/nonexistent/stats.json"));
}

TEST_CASE("CSV cells are quoted only where they must be", "[csv]") {
  CsvTable table({"name", "time_ns", "share"});
  table.add_row({"plain", 12, 0.1});
  table.add_row({"a,b", uint64_t{18446744073709551615u}, 1.5f});
  table.add_row({"say \"hi\"", -3, std::numeric_limits<double>::infinity()});
  table.add_row({"two\nlines", 0, 1e-300});
  CHECK(table.text() ==
        "name,time_ns,share\n"
        "plain,12,0.1\n"
        "\"a,b\",18446744073709551615,1.5\n"
        "\"say \"\"hi\"\"\",-3,inf\n"
        "\"two\nlines\",0,1e-300\n");
}

TEST_CASE("a CSV row of another length than the header is refused", "[csv]") {
  CsvTable table({"a", "b"});
  CHECK_THROWS_AS(table.add_row({1}), std::invalid_argument);
  CHECK_THROWS_AS(table.add_row({1, 2, 3}), std::invalid_argument);
  CHECK(table.text() == "a,b\n");
}

TEST_CASE("the version names project, compiler and build type", "[version]") {
  CHECK(std::string(version().number) == "0.1.0");
  CHECK(version_text().rfind("0.1.0 (", 0) == 0);
  CHECK(version_text().find(version().compiler) != std::string::npos);
  CHECK(version_text().find(version().build_type) != std::string::npos);
}
