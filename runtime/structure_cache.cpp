#include <rayloom/accel/build.h>
#include <rayloom/accel/build_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/structure.h>
#include <rayloom/base/error.h>
#include <rayloom/runtime/structure_cache.h>

#include <cinttypes>
#include <cstdio>
#include <unordered_map>
#include <utility>

namespace rayloom::detail {
namespace {

std::string hexadecimal(uint64_t address) {
  char text[32];
  std::snprintf(text, sizeof(text), "0x%" PRIx64, address);
  return text;
}

/// Finds out what lies at an address and whether it can be traced.
class Inspector {
 public:
  Inspector(const DeviceMemory& memory, uint64_t address) : memory_(memory), address_(address) {}

  TopLevel inspect() {
    if (const accel::StructureHeader* header = structure_at(address_)) {
      if (header->kind != accel::StructureKind::instances)
        reject("TL-12", "the structure at " + hexadecimal(address_) + " is a bottom level");
      else
        collect(*header);
    } else {
      reject("TL-12", "there is no acceleration structure at " + hexadecimal(address_));
    }
    if (result_.problem.empty())
      result_.block = memory_.host(address_);
    else
      result_.instances.clear();
    return std::move(result_);
  }

 private:
  void reject(std::string_view row, std::string problem) {
    if (!result_.problem.empty()) return;
    result_.row = row;
    result_.problem = std::move(problem);
  }

  /// The header of a whole structure in committed memory, else null.
  const accel::StructureHeader* structure_at(uint64_t address) const {
    if (address % accel::structure_alignment != 0 || !memory_.holds(address, sizeof(accel::StructureHeader)))
      return nullptr;
    const auto* header = reinterpret_cast<const accel::StructureHeader*>(memory_.host(address));
    try {
      accel::structure_info(memory_.host(address));
    } catch (const InputError&) {
      return nullptr;
    }
    return memory_.holds(address, header->bytes) ? header : nullptr;
  }

  /// Walks the tree; every reference must stay inside the block.
  void collect(const accel::StructureHeader& header) {
    result_.instances.resize(header.primitive_count);
    if (const uint32_t root = accel::root_of(header); root != accel::no_index) pending_.push_back(root);
    for (uint64_t visited = 0; !pending_.empty() && result_.problem.empty(); ++visited) {
      const uint32_t ref = pending_.back();
      pending_.pop_back();
      const uint64_t size = accel::node_ref::is_leaf(ref) ? sizeof(accel::InstanceRecord) : sizeof(accel::Node8);
      const uint64_t offset = accel::node_ref::offset(ref);
      if (offset + size > header.bytes || visited > uint64_t{header.node_count} + header.leaf_count)
        return reject("ERR-08", "the structure at " + hexadecimal(address_) + " is damaged");
      const std::byte* const item = memory_.host(address_) + offset;
      if (accel::node_ref::is_leaf(ref))
        add(*reinterpret_cast<const accel::InstanceRecord*>(item));
      else
        push_children(*reinterpret_cast<const accel::Node8*>(item));
    }
  }

  void push_children(const accel::Node8& node) {
    for (int i = 0; i < 8; ++i)
      if (node.bounds[0][0][i] <= node.bounds[0][1][i]) pending_.push_back(node.child[i]);
  }

  void add(const accel::InstanceRecord& record) {
    if (record.instance_index >= result_.instances.size())
      return reject("ERR-08", "the structure at " + hexadecimal(address_) + " is damaged");
    const accel::StructureHeader* const bottom = bottom_level_at(record.bottom_level_address);
    if (!bottom || bottom->kind == accel::StructureKind::instances)
      return reject("TL-11", "instance " + std::to_string(record.instance_index) + " of the structure at " +
                                 hexadecimal(address_) + " refers to " + hexadecimal(record.bottom_level_address) +
                                 ", where there is no bottom level any more");
    if (accel::node_ref::offset(record.entry) >= bottom->bytes)
      return reject("ERR-08", "the structure at " + hexadecimal(address_) + " is damaged");
    result_.instances[record.instance_index] = &record;  // re-braided: any of its records, they differ in `entry` only
    note_candidates(record.contribution_and_flags >> 24, *bottom);
  }

  /// Many instances share few bottom levels: each of those is checked once.
  const accel::StructureHeader* bottom_level_at(uint64_t address) {
    if (address == last_bottom_level_.first) return last_bottom_level_.second;
    const auto [found, inserted] = bottom_levels_.try_emplace(address, nullptr);
    if (inserted) found->second = structure_at(address);
    last_bottom_level_ = *found;
    return found->second;
  }

  void note_candidates(uint32_t instance_flags, const accel::StructureHeader& bottom) {
    if (bottom.kind == accel::StructureKind::procedurals) result_.has_procedurals = true;
    if (bottom.kind != accel::StructureKind::triangles || (instance_flags & accel::instance_flag::force_opaque)) return;
    result_.has_non_opaque |=
        bottom.non_opaque_count != 0 || (instance_flags & accel::instance_flag::force_non_opaque) != 0;
  }

  const DeviceMemory& memory_;
  uint64_t address_;
  TopLevel result_;
  std::vector<uint32_t> pending_;
  std::unordered_map<uint64_t, const accel::StructureHeader*> bottom_levels_;
  std::pair<uint64_t, const accel::StructureHeader*> last_bottom_level_{};
};

}  // namespace

bool TopLevel::asks(uint32_t ray_flags) const {
  using namespace accel;
  if (has_procedurals && !(ray_flags & ray_flag::skip_procedural_primitives)) return true;
  if (ray_flags & (ray_flag::skip_triangles | ray_flag::force_opaque | ray_flag::cull_non_opaque)) return false;
  return has_non_opaque || (ray_flags & ray_flag::force_non_opaque);
}

TopLevel StructureCache::inspect(uint64_t address) const {
  TopLevel found = Inspector(memory_, address).inspect();
  if (complete_ && found.block) accel::complete_structure(memory_.host(address), memory_.addresses());
  return found;
}

const TopLevel& StructureCache::find(uint64_t address) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(address);
  if (found != entries_.end()) return found->second;
  return entries_.emplace(address, inspect(address)).first->second;
}

}  // namespace rayloom::detail
