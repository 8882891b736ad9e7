#include "checker.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <cmath>

namespace rayloom::scenes::gltf {

void Checker::fail(const std::string& path, const std::string& rule) const { throw InputError(file_, path, rule); }

Checker Checker::element(const Json& list, const char* key, size_t i) const {
  const std::string path = path_of(fmt::format("{}[{}]", key, i));
  if (!list[i].is_object()) fail(path, "must be an object");
  return Checker(*this, list[i], path);
}

const Json* Checker::find(const char* key, Need need) const {
  const auto found = object_.find(key);
  if (found != object_.end()) return &*found;
  if (need == Need::required) fail(fmt::format("'{}' is missing", key));
  return nullptr;
}

const Json* Checker::typed(const char* key, bool (Json::*is)() const noexcept, const char* what, Need need) const {
  const Json* value = find(key, need);
  if (value && !(value->*is)()) fail(path_of(key), fmt::format("must be {}", what));
  return value;
}

const Json* Checker::array(const char* key, Need need) const {
  const Json* value = typed(key, &Json::is_array, "an array", need);
  if (value && need == Need::required && value->empty()) fail(path_of(key), "must not be empty");
  return value;
}

void Checker::text(const char* key, Need need) const { typed(key, &Json::is_string, "a string", need); }
void Checker::boolean(const char* key) const { typed(key, &Json::is_boolean, "true or false", Need::optional); }

void Checker::check_number(const Json& value, const std::string& path, Range range) const {
  if (!value.is_number()) fail(path, "must be a number");
  const double number = value.get<double>();
  const bool too_small = range.above_min ? !(number > range.min) : !(number >= range.min);
  if (std::fabs(number) > std::numeric_limits<float>::max()) fail(path, fmt::format("{} is too large", number));
  if (too_small || number > range.max) {
    const char* bound = range.above_min ? "above" : "at least";
    fail(path, range.max < std::numeric_limits<double>::infinity()
                   ? fmt::format("{} must be {} {} and at most {}", number, bound, range.min, range.max)
                   : fmt::format("{} must be {} {}", number, bound, range.min));
  }
}

void Checker::number(const char* key, Range range, Need need) const {
  const Json* value = find(key, need);
  if (value) check_number(*value, path_of(key), range);
}

void Checker::numbers(const char* key, size_t length, Range range) const {
  const Json* list = array(key);
  if (!list) return;
  if (length != 0 && list->size() != length) {
    fail(path_of(key), fmt::format("must have {} numbers, it has {}", length, list->size()));
  }
  for (size_t i = 0; i < list->size(); ++i) check_number((*list)[i], path_of(fmt::format("{}[{}]", key, i)), range);
}

void Checker::whole(const char* key, uint64_t min, uint64_t max, Need need) const {
  const Json* value = find(key, need);
  if (!value) return;
  if (!value->is_number_unsigned()) fail(path_of(key), "must be a whole number, not negative");
  const uint64_t number = value->get<uint64_t>();
  if (number < min || number > max) {
    fail(path_of(key), fmt::format("{} must be at least {} and at most {}", number, min, max));
  }
}

void Checker::one_of(const char* key, std::initializer_list<int> values, Need need) const {
  const Json* value = find(key, need);
  if (!value) return;
  std::string allowed;
  for (const int candidate : values) {
    if (value->is_number_integer() && *value == candidate) return;
    allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", candidate);
  }
  fail(path_of(key), "must be one of " + allowed);
}

void Checker::one_of(const char* key, std::initializer_list<const char*> values, Need need) const {
  const Json* value = find(key, need);
  if (!value) return;
  std::string allowed;
  for (const char* candidate : values) {
    if (value->is_string() && *value == candidate) return;
    allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", candidate);
  }
  fail(path_of(key), "must be one of " + allowed);
}

size_t Checker::collection_size(const char* collection) const {
  const auto found = root_.find(collection);
  return found == root_.end() ? 0 : found->size();
}

void Checker::check_index(const Json& value, const std::string& path, const char* collection) const {
  if (!value.is_number_unsigned()) fail(path, fmt::format("must be an index into '{}'", collection));
  const size_t size = collection_size(collection);
  if (value.get<uint64_t>() < size) return;
  fail(path, fmt::format("index {} is out of range, the file has {} {}", value.get<uint64_t>(), size, collection));
}

void Checker::index(const char* key, const char* collection, Need need) const {
  const Json* value = find(key, need);
  if (value) check_index(*value, path_of(key), collection);
}

void Checker::index_list(const char* key, const char* collection, Need need) const {
  const Json* list = array(key, need);
  for (size_t i = 0; list && i < list->size(); ++i) {
    check_index((*list)[i], path_of(fmt::format("{}[{}]", key, i)), collection);
  }
}

void Checker::all_indices(const char* collection) const {
  for (const auto& [key, value] : object_.items()) check_index(value, path_of(key), collection);
}

}  // namespace rayloom::scenes::gltf
