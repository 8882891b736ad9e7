#pragma once

// Which root signature an export has: associations of checklist section 3, for one scope.

#include <rayloom/runtime/state_object_desc.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rayloom::detail {

/// One kind of root signature and who is associated with which.
class RootAssociations {
 public:
  /// `kind` is "global root signature" or "local root signature". Throws InputError for conflicts (ASC-09, ASC-16).
  template <class Subobject>
  static RootAssociations collect(const STATE_OBJECT_DESC& desc, std::string kind);

  /// The signature named for this export itself, if any.
  const RootSignature* explicit_for(const std::string& export_name) const;
  const RootSignature* default_signature() const { return default_ ? &*default_ : nullptr; }
  const RootSignature* effective(const std::string& export_name) const {
    const RootSignature* own = explicit_for(export_name);
    return own ? own : default_signature();
  }

 private:
  struct Declared {
    size_t subobject;
    RootSignature signature;
    bool named = false;         // by an association with exports
    bool made_default = false;  // by an association without
  };

  void associate(Declared& declared, const SUBOBJECT_TO_EXPORTS_ASSOCIATION& association);
  void choose_default(const std::vector<Declared>& declared);

  std::string kind_;
  std::map<std::string, RootSignature> explicit_;
  std::optional<RootSignature> default_;
};

}  // namespace rayloom::detail
