#include "importer.h"

#include <rayloom/base/det_math.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace rayloom::scenes::gltf {
namespace {

constexpr size_t max_depth = 1024;
constexpr size_t max_name_in_path = 64;
constexpr int no_parent = -1;

std::string node_name(size_t node) { return fmt::format("nodes[{}]", node); }

std::vector<int> find_parents(const Importer& importer) {
  const auto& nodes = importer.model().nodes;
  std::vector<int> parents(nodes.size(), no_parent);
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      int& parent = parents[static_cast<size_t>(child)];
      if (parent != no_parent) {
        importer.fail(node_name(static_cast<size_t>(child)),
                      fmt::format("has several parents: nodes[{}] and nodes[{}]", parent, i));
      }
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

/// With one parent each, a node is on a cycle or below one exactly if its ancestors never end.
void check_no_cycles(const Importer& importer, const std::vector<int>& parents) {
  std::vector<size_t> visited_from(parents.size(), parents.size());
  for (size_t start = 0; start < parents.size(); ++start) {
    for (int node = static_cast<int>(start); node != no_parent; node = parents[static_cast<size_t>(node)]) {
      size_t& mark = visited_from[static_cast<size_t>(node)];
      if (mark == start) importer.fail(node_name(static_cast<size_t>(node)), "is its own ancestor (cyclic nodes)");
      if (mark < start) break;
      mark = start;
    }
  }
}

glm::dmat4 local_matrix(const Importer& importer, size_t index) {
  const tinygltf::Node& node = importer.model().nodes[index];
  glm::dmat4 matrix(1);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[static_cast<size_t>(i)];
    const bool affine = matrix[0][3] == 0 && matrix[1][3] == 0 && matrix[2][3] == 0 && matrix[3][3] == 1;
    if (!affine) importer.fail(node_name(index) + ".matrix", "the last row must be 0 0 0 1");
    return matrix;
  }
  if (node.rotation.size() == 4) {
    const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = std::sqrt(glm::dot(q, q));
    if (!(length > 1e-6)) importer.fail(node_name(index) + ".rotation", "the quaternion has no length");
    matrix = glm::mat4_cast(q / length);
  }
  for (int i = 0; i < 3 && node.scale.size() == 3; ++i) matrix[i] *= node.scale[static_cast<size_t>(i)];
  for (int i = 0; i < 3 && node.translation.size() == 3; ++i) matrix[3][i] = node.translation[static_cast<size_t>(i)];
  return matrix;
}

/// The shown scene's roots: of the default scene, else of the first, else every node without a parent.
std::vector<int> find_roots(const Importer& importer, const std::vector<int>& parents) {
  const tinygltf::Model& model = importer.model();
  std::vector<int> roots;
  if (!model.scenes.empty()) {
    const size_t scene = model.defaultScene >= 0 ? static_cast<size_t>(model.defaultScene) : 0;
    roots = model.scenes[scene].nodes;
    for (size_t i = 0; i < roots.size(); ++i) {
      if (parents[static_cast<size_t>(roots[i])] == no_parent) continue;
      importer.fail(fmt::format("scenes[{}].nodes[{}]", scene, i), fmt::format("nodes[{}] is no root node", roots[i]));
    }
    return roots;
  }
  for (size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == no_parent) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

std::string path_name(const tinygltf::Node& node, int index) {
  return node.name.empty() ? fmt::format("#{}", index) : node.name.substr(0, max_name_in_path);
}

struct Pending {
  int node;
  std::string parent_path;
  glm::dmat4 parent_world;
  size_t depth;
};

void visit(Importer& importer, const Pending& pending, std::vector<Pending>& stack, std::vector<VisitedNode>& visited) {
  const auto index = static_cast<size_t>(pending.node);
  const tinygltf::Node& node = importer.model().nodes[index];
  if (importer.shown[index]) importer.fail(node_name(index), "appears twice in the scene");
  if (pending.depth > max_depth) importer.fail(node_name(index), fmt::format("deeper than {} nodes", max_depth));
  importer.shown[index] = true;
  importer.world[index] = pending.parent_world * local_matrix(importer, index);
  const std::string path = pending.parent_path + path_name(node, pending.node);
  visited.push_back({pending.node, path});
  for (size_t i = node.children.size(); i-- > 0;) {
    stack.push_back({node.children[i], path + "/", importer.world[index], pending.depth + 1});
  }
}

Transform3x4 as_transform(const Importer& importer, const glm::dmat4& matrix, size_t node) {
  Transform3x4 transform;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const auto value = static_cast<float>(matrix[column][row]);
      if (!std::isfinite(value)) importer.fail(node_name(node), "the world transform is not finite");
      transform[static_cast<size_t>(4 * row + column)] = value;
    }
  }
  return transform;
}

/// What makes two nodes' meshes differ: the source, the skin's node, the morph weights.
using MeshKey = std::tuple<int, int, std::vector<double>>;

MeshKey mesh_key(const Importer& importer, const VisitedNode& visited) {
  const tinygltf::Node& node = importer.model().nodes[static_cast<size_t>(visited.node)];
  const tinygltf::Mesh& mesh = importer.model().meshes[static_cast<size_t>(node.mesh)];
  return {node.mesh, node.skin >= 0 ? visited.node : -1, node.weights.empty() ? mesh.weights : node.weights};
}

/// The index in scene.meshes, or none when nothing of the mesh can be shown.
uint32_t add_mesh(Importer& importer, const MeshKey& key) {
  const auto& [mesh_index, skin_node, weights] = key;
  Mesh mesh = import_mesh(importer, mesh_index, weights);
  if (mesh.geometries.empty()) return ~0u;
  if (skin_node >= 0) apply_skin(importer, mesh_index, skin_node, mesh);
  importer.scene.meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(importer.scene.meshes.size() - 1);
}

double member(const tinygltf::Value& object, const char* key, double missing) {
  return object.Has(key) ? object.Get(key).GetNumberAsDouble() : missing;
}

glm::dvec3 unit(const Importer& importer, glm::dvec3 v, size_t node) {
  const double length = std::sqrt(glm::dot(v, v));
  if (!(length > 0) || !std::isfinite(length))
    importer.fail(node_name(node), "a camera or light needs an invertible transform");
  return v / length;
}

void check_finite(const Importer& importer, glm::vec3 v, size_t node) {
  if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) return;
  importer.fail(node_name(node), "a camera's or light's position or intensity is not finite");
}

Light import_light(const Importer& importer, const tinygltf::Light& source, size_t node) {
  const glm::dmat4& world = importer.world[node];
  Light light;
  light.kind = source.type == "point"  ? Light::Kind::point
               : source.type == "spot" ? Light::Kind::spot
                                       : Light::Kind::directional;
  light.name = source.name.empty() ? importer.model().nodes[node].name : source.name;
  light.position = glm::vec3(world[3]);
  if (light.kind != Light::Kind::point) light.direction = glm::vec3(unit(importer, -glm::dvec3(world[2]), node));
  const glm::dvec3 color =
      source.color.size() == 3 ? glm::dvec3(source.color[0], source.color[1], source.color[2]) : glm::dvec3(1);
  light.intensity = glm::vec3(color * source.intensity);
  check_finite(importer, light.position, node);
  check_finite(importer, light.intensity, node);
  if (source.range > 0) light.range = static_cast<float>(source.range);
  if (light.kind == Light::Kind::spot) {
    light.cos_inner_cone = static_cast<float>(det::cos(source.spot.innerConeAngle));
    light.cos_outer_cone = static_cast<float>(det::cos(source.spot.outerConeAngle));
  }
  return light;
}

SceneCamera import_camera(const Importer& importer, const tinygltf::Camera& source, size_t node) {
  const glm::dmat4& world = importer.world[node];
  SceneCamera camera;
  camera.name = source.name.empty() ? importer.model().nodes[node].name : source.name;
  camera.position = glm::vec3(world[3]);
  check_finite(importer, camera.position, node);
  const glm::dvec3 backward = unit(importer, glm::dvec3(world[2]), node);
  const glm::dvec3 y(world[1]), x(world[0]);
  const glm::dvec3 up = unit(importer, y - glm::dot(y, backward) * backward, node);
  const glm::dvec3 right = unit(importer, x - glm::dot(x, backward) * backward - glm::dot(x, up) * up, node);
  camera.backward = glm::vec3(backward), camera.up = glm::vec3(up), camera.right = glm::vec3(right);
  if (source.type == "perspective") {
    camera.yfov = static_cast<float>(source.perspective.yfov);
    camera.aspect = static_cast<float>(source.perspective.aspectRatio);
    camera.znear = static_cast<float>(source.perspective.znear);
    if (source.perspective.zfar > 0) camera.zfar = static_cast<float>(source.perspective.zfar);
  } else {
    camera.kind = SceneCamera::Kind::orthographic;
    camera.xmag = static_cast<float>(source.orthographic.xmag);
    camera.ymag = static_cast<float>(source.orthographic.ymag);
    camera.znear = static_cast<float>(source.orthographic.znear);
    camera.zfar = static_cast<float>(source.orthographic.zfar);
  }
  return camera;
}

}  // namespace

std::vector<VisitedNode> visit_nodes(Importer& importer) {
  const std::vector<int> parents = find_parents(importer);
  check_no_cycles(importer, parents);
  importer.world.assign(parents.size(), glm::dmat4(1));
  importer.shown.assign(parents.size(), false);
  std::vector<Pending> stack;
  const std::vector<int> roots = find_roots(importer, parents);
  for (size_t i = roots.size(); i-- > 0;) stack.push_back({roots[i], "", glm::dmat4(1), 1});
  std::vector<VisitedNode> visited;
  while (!stack.empty()) {
    const Pending next = std::move(stack.back());
    stack.pop_back();
    visit(importer, next, stack, visited);
  }
  return visited;
}

void import_instances(Importer& importer, const std::vector<VisitedNode>& nodes) {
  std::map<MeshKey, uint32_t> meshes;
  for (const VisitedNode& visited : nodes) {
    const auto index = static_cast<size_t>(visited.node);
    const tinygltf::Node& node = importer.model().nodes[index];
    if (node.mesh < 0) continue;
    const MeshKey key = mesh_key(importer, visited);
    auto found = meshes.find(key);
    if (found == meshes.end()) found = meshes.emplace(key, add_mesh(importer, key)).first;
    if (found->second == ~0u) continue;
    Instance instance{found->second, identity_transform, node.name, visited.path};
    // glTF 2.0, 3.7.3.1: the transform of a skinned node is ignored, its joints say where the vertices are.
    if (node.skin < 0) instance.transform = as_transform(importer, importer.world[index], index);
    importer.scene.instances.push_back(std::move(instance));
  }
}

void import_cameras(Importer& importer, const std::vector<VisitedNode>& nodes) {
  for (const VisitedNode& visited : nodes) {
    const auto index = static_cast<size_t>(visited.node);
    const int camera = importer.model().nodes[index].camera;
    if (camera < 0) continue;
    importer.scene.cameras.push_back(
        import_camera(importer, importer.model().cameras[static_cast<size_t>(camera)], index));
  }
}

void import_lights(Importer& importer, const std::vector<VisitedNode>& nodes) {
  for (const VisitedNode& visited : nodes) {
    const auto index = static_cast<size_t>(visited.node);
    const auto& extensions = importer.model().nodes[index].extensions;
    const auto reference = extensions.find("KHR_lights_punctual");
    if (reference == extensions.end()) continue;
    const auto light = static_cast<size_t>(member(reference->second, "light", 0));
    importer.scene.lights.push_back(import_light(importer, importer.model().lights[light], index));
  }
}

}  // namespace rayloom::scenes::gltf
