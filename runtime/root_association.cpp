#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/root_association.h>

#include <algorithm>

namespace rayloom::detail {

template <class Subobject>
RootAssociations RootAssociations::collect(const STATE_OBJECT_DESC& desc, std::string kind) {
  RootAssociations result;
  result.kind_ = std::move(kind);
  std::vector<Declared> declared;
  for (size_t i = 0; i < desc.Subobjects.size(); ++i)
    if (const auto* subobject = std::get_if<Subobject>(&desc.Subobjects[i]))
      declared.push_back({i, subobject->Signature});
  for (const STATE_SUBOBJECT& subobject : desc.Subobjects)
    if (const auto* association = std::get_if<SUBOBJECT_TO_EXPORTS_ASSOCIATION>(&subobject))
      for (Declared& target : declared)
        if (target.subobject == association->SubobjectToAssociate) result.associate(target, *association);
  result.choose_default(declared);
  return result;
}

template RootAssociations RootAssociations::collect<GLOBAL_ROOT_SIGNATURE>(const STATE_OBJECT_DESC&, std::string);
template RootAssociations RootAssociations::collect<LOCAL_ROOT_SIGNATURE>(const STATE_OBJECT_DESC&, std::string);

void RootAssociations::associate(Declared& declared, const SUBOBJECT_TO_EXPORTS_ASSOCIATION& association) {
  (association.Exports.empty() ? declared.made_default : declared.named) = true;
  for (const std::string& name : association.Exports) {
    const auto [entry, inserted] = explicit_.emplace(name, declared.signature);
    if (!inserted && entry->second != declared.signature)
      fail_creation("export '" + name + "'", "ASC-09", "is associated with two different " + kind_ + "s");
  }
}

/// An explicit default beats declarations (RW-04); a declaration that no association names is a default (ASC-02,
/// RW-05).
void RootAssociations::choose_default(const std::vector<Declared>& declared) {
  const bool explicit_default = std::any_of(declared.begin(), declared.end(), [](auto& d) { return d.made_default; });
  for (const Declared& candidate : declared) {
    if (explicit_default ? !candidate.made_default : candidate.named) continue;
    if (default_ && *default_ != candidate.signature)
      fail_creation(kind_, "ASC-16", "two different ones would be the default");
    default_ = candidate.signature;
  }
}

const RootSignature* RootAssociations::explicit_for(const std::string& export_name) const {
  const auto found = explicit_.find(export_name);
  return found == explicit_.end() ? nullptr : &found->second;
}

}  // namespace rayloom::detail
