#pragma once

// What the steps of an import share: the checked document, the scene being filled, what is still to be warned of.

#include <rayloom/scenes/gltf/accessors.h>
#include <rayloom/scenes/scene.h>

#include <map>
#include <span>
#include <tuple>

namespace rayloom::scenes::gltf {

struct Importer {
  explicit Importer(Document source) : document(std::move(source)), budget(document), reader(document, budget) {}

  const Document document;
  Scene scene;
  Budget budget;
  AccessorReader reader;
  std::vector<glm::dmat4> world;  ///< of every node of the shown scene
  std::vector<bool> shown;        ///< nodes of the shown scene

  const tinygltf::Model& model() const { return document.model; }
  [[noreturn]] void fail(const std::string& object, const std::string& rule) const;
  /// Adds a sentence to the scene's warnings unless it is there already.
  void warn(const std::string& sentence);
};

// The steps, in order.
void import_textures(Importer& importer);
void import_materials(Importer& importer);
/// World matrices of the default scene's nodes; InputError for cycles, several parents, roots that are no roots.
/// Returns the nodes in depth-first order of the file's lists, with their paths.
struct VisitedNode {
  int node;
  std::string path;
};
std::vector<VisitedNode> visit_nodes(Importer& importer);
void import_instances(Importer& importer, const std::vector<VisitedNode>& nodes);
void import_cameras(Importer& importer, const std::vector<VisitedNode>& nodes);
void import_lights(Importer& importer, const std::vector<VisitedNode>& nodes);

/// The geometries of a mesh with its morph targets at `weights`; primitives that are no triangles are skipped.
Mesh import_mesh(Importer& importer, int mesh, std::span<const double> weights);
/// Moves a mesh's vertices to where the node's skin puts them, in world space.
void apply_skin(Importer& importer, int mesh_index, int node, Mesh& mesh);

}  // namespace rayloom::scenes::gltf
