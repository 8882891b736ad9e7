#include <rayloom/base/json.h>

#include <rayloom/base/output_file.h>
#include <rayloom/base/version.h>

namespace rayloom {

Json json_document(std::string_view schema, unsigned schema_version) {
  return {{"schema", schema}, {"schema_version", schema_version}, {"rayloom_version", version().number}};
}

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

void write_json(const std::string& path, const Json& json) { write_file(path, json_text(json)); }

}  // namespace rayloom
