#include <rayloom/runtime/state_object_desc.h>

namespace rayloom {

size_t STATE_OBJECT_DESC::add(STATE_SUBOBJECT subobject) {
  Subobjects.push_back(std::move(subobject));
  return Subobjects.size() - 1;
}

}  // namespace rayloom
