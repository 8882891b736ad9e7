#pragma once

// One JSON object of a glTF file with its path, and the questions a schema asks of its members. Every failed question
// is an InputError "file: materials[2].normalTexture: index 7 is out of range, the file has 3 textures".

#include <rayloom/scenes/gltf/schema.h>

#include <initializer_list>
#include <limits>

namespace rayloom::scenes::gltf {

struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself is excluded
};
inline constexpr Range any{};
inline constexpr Range unit{0, 1};
inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range not_negative{0};

enum class Need { optional, required };

class Checker {
 public:
  Checker(const std::string& file, const Json& root) : file_(file), root_(root), object_(root) {}

  /// Calls check(Checker) for each object of the array `key`.
  template <typename Check>
  void each(const char* key, Check check, Need need = Need::optional) const {
    const Json* list = array(key, need);
    for (size_t i = 0; list && i < list->size(); ++i) check(element(*list, key, i));
  }
  /// Calls check(Checker) for the object `key`.
  template <typename Check>
  void object(const char* key, Check check, Need need = Need::optional) const {
    const Json* value = typed(key, &Json::is_object, "an object", need);
    if (value) check(Checker(*this, *value, path_of(key)));
  }

  const Json* array(const char* key, Need need = Need::optional) const;
  void text(const char* key, Need need = Need::optional) const;
  void boolean(const char* key) const;
  void number(const char* key, Range range = any, Need need = Need::optional) const;
  /// `length` 0: any.
  void numbers(const char* key, size_t length, Range range = any) const;
  /// A whole number in [min, max].
  void whole(const char* key, uint64_t min, uint64_t max, Need need = Need::optional) const;
  void one_of(const char* key, std::initializer_list<int> values, Need need = Need::optional) const;
  void one_of(const char* key, std::initializer_list<const char*> values, Need need = Need::optional) const;
  /// An index into the root array `collection`.
  void index(const char* key, const char* collection, Need need = Need::optional) const;
  void index_list(const char* key, const char* collection, Need need = Need::optional) const;
  /// Every member of this object is an index into `collection`.
  void all_indices(const char* collection) const;

  bool has(const char* key) const { return object_.contains(key); }
  const Json& json() const { return object_; }
  size_t collection_size(const char* collection) const;
  [[noreturn]] void fail(const std::string& path, const std::string& rule) const;
  [[noreturn]] void fail(const std::string& rule) const { fail(path_, rule); }

 private:
  Checker(const Checker& parent, const Json& object, std::string path)
      : file_(parent.file_), root_(parent.root_), object_(object), path_(std::move(path)) {}

  Checker element(const Json& list, const char* key, size_t i) const;
  const Json* find(const char* key, Need need) const;
  const Json* typed(const char* key, bool (Json::*is)() const noexcept, const char* what, Need need) const;
  std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  void check_index(const Json& value, const std::string& path, const char* collection) const;
  void check_number(const Json& value, const std::string& path, Range range) const;

  const std::string& file_;
  const Json& root_;
  const Json& object_;
  std::string path_;
};

}  // namespace rayloom::scenes::gltf
