#pragma once

// From trees to the bytes of layout.h.

#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/wide_tree.h>
#include <rayloom/base/parallel.h>

#include <cstddef>

namespace rayloom::accel {

/// Writes one Node8 at its place in `block`.
void write_node(const BinaryTree& tree, const WideNode& node, std::byte* block);

/// Writes all nodes, and all leaves by write_leaf(slot, address).
template <class WriteLeaf>
void write_nodes(const BinaryTree& tree, const WideTree& wide, std::byte* block, const WriteLeaf& write_leaf) {
  parallel_for(wide.nodes.size(), 256, [&](uint64_t begin, uint64_t end) {
    for (const WideNode& node : std::span(wide.nodes).subspan(begin, end - begin)) {
      write_node(tree, node, block);
      for (uint32_t i = 0; i < node.children.count; ++i)
        if (node_ref::is_leaf(node.child_ref[i]))
          write_leaf(node.children.slot[i], block + node_ref::offset(node.child_ref[i]));
    }
  });
}

/// The same with leaves by write_leaf(range, address) where `range` are the leaf's primitives.
template <class WriteLeaf>
void write_tree(const BinaryTree& tree, const WideTree& wide, std::span<const PrimitiveRef> refs, std::byte* block,
                const WriteLeaf& write_leaf) {
  write_nodes(tree, wide, block, [&](uint32_t slot, std::byte* address) {
    write_leaf(refs.subspan(tree[slot].first, tree[slot].count), address);
  });
}

/// Header of a structure without active primitives; the caller fills in the counts.
StructureHeader empty_header(StructureKind kind, const BuildSettings& settings);

/// Enters what the tree says of itself: root, size, depth, counts, bounds, cost.
void describe_tree(const BinaryTree& tree, const WideTree& wide, size_t active, StructureHeader& header);

}  // namespace rayloom::accel
