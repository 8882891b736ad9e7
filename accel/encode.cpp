#include <rayloom/accel/encode.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/tree_builder.h>

#include <cassert>
#include <cstring>

namespace rayloom::accel {

void write_node(const BinaryTree& tree, const WideNode& node, std::byte* block) {
  Node8 out{};
  for (uint32_t i = 0; i < node_width; ++i) {
    const Box box = i < node.children.count ? tree[node.children.slot[i]].box : Box{};
    for (int axis = 0; axis < 3; ++axis) {
      out.bounds[axis][0][i] = box.min[axis];
      out.bounds[axis][1][i] = box.max[axis];
    }
    out.child[i] = node.child_ref[i];
  }
  std::memcpy(block + node_ref::offset(node.ref), &out, sizeof(out));
}

StructureHeader empty_header(StructureKind kind, const BuildSettings& settings) {
  StructureHeader header{};
  header.magic = structure_magic;
  header.kind = kind;
  header.build_flags = settings.flags;
  header.builder = static_cast<uint32_t>(chosen_builder(kind, settings));
  header.bytes = sizeof(StructureHeader);
  header.root = no_index;
  header.pad_scale = 1;
  return header;
}

void describe_tree(const BinaryTree& tree, const WideTree& wide, size_t active, StructureHeader& header) {
  assert(wide.depth <= max_depth);  // what the traversal stack is made for
  header.root = wide.nodes[0].ref;
  header.bytes = wide.bytes;
  header.depth = wide.depth;
  header.node_count = static_cast<uint32_t>(wide.nodes.size());
  header.leaf_count = static_cast<uint32_t>(wide.leaf_count);
  header.active_count = active;
  header.sah_cost = wide.sah_cost;
  for (int k = 0; k < 3; ++k) {
    header.bounds_min[k] = tree[0].box.min[k];
    header.bounds_max[k] = tree[0].box.max[k];
  }
}

}  // namespace rayloom::accel
