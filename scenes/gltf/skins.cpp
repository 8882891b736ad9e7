#include "importer.h"

#include <fmt/format.h>

#include <cmath>

namespace rayloom::scenes::gltf {
namespace {

/// JOINTS_n and WEIGHTS_n of one primitive, sets one after another: four influences a vertex and set.
struct Influences {
  size_t sets = 0;
  std::vector<std::vector<uint32_t>> joints;
  std::vector<std::vector<glm::vec4>> weights;
};

Influences read_influences(Importer& importer, const tinygltf::Primitive& primitive, const std::string& object,
                           size_t vertices, size_t joint_count) {
  Influences all;
  for (;; ++all.sets) {
    const auto joints = primitive.attributes.find(fmt::format("JOINTS_{}", all.sets));
    const auto weights = primitive.attributes.find(fmt::format("WEIGHTS_{}", all.sets));
    if (joints == primitive.attributes.end() || weights == primitive.attributes.end()) return all;
    const std::string user = fmt::format("{}.attributes.{}", object, joints->first);
    const tinygltf::Accessor& j = importer.reader.at(joints->second);
    const tinygltf::Accessor& w = importer.reader.at(weights->second);
    const bool integer = j.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                         j.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (j.type != TINYGLTF_TYPE_VEC4 || !integer || w.type != TINYGLTF_TYPE_VEC4) {
      importer.fail(user, "joints must be VEC4 of unsigned bytes or shorts, weights VEC4");
    }
    if (j.count != vertices || w.count != vertices) {
      importer.fail(user, fmt::format("{} joints and {} weights for {} vertices", j.count, w.count, vertices));
    }
    all.joints.push_back(importer.reader.read_uints(joints->second, user));
    all.weights.push_back(importer.reader.read<glm::vec4>(weights->second, user));
    for (const uint32_t joint : all.joints.back()) {
      if (joint < joint_count) continue;
      importer.fail(user, fmt::format("joint {} is out of range, the skin has {} joints", joint, joint_count));
    }
  }
}

/// World matrix of each joint times its inverse bind matrix (glTF 2.0, 3.7.3.3).
std::vector<glm::dmat4> joint_matrices(Importer& importer, int skin_index) {
  const tinygltf::Skin& skin = importer.model().skins[static_cast<size_t>(skin_index)];
  const std::string object = fmt::format("skins[{}]", skin_index);
  std::vector<glm::mat4> inverse_bind(skin.joints.size(), glm::mat4(1));
  if (skin.inverseBindMatrices >= 0) {
    const tinygltf::Accessor& accessor = importer.reader.at(skin.inverseBindMatrices);
    if (accessor.type != TINYGLTF_TYPE_MAT4 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT ||
        accessor.count < skin.joints.size()) {
      importer.fail(object, "inverseBindMatrices must be a float MAT4 accessor with one matrix a joint");
    }
    inverse_bind = importer.reader.read<glm::mat4>(skin.inverseBindMatrices, object + ".inverseBindMatrices");
  }
  std::vector<glm::dmat4> matrices;
  for (size_t i = 0; i < skin.joints.size(); ++i) {
    const auto joint = static_cast<size_t>(skin.joints[i]);
    if (!importer.shown[joint]) {
      importer.fail(object, fmt::format("joint nodes[{}] is not part of the scene", joint));
    }
    matrices.push_back(importer.world[joint] * glm::dmat4(inverse_bind[i]));
  }
  return matrices;
}

/// The weighted matrix of a vertex; weights are divided by their sum, a vertex without any follows its first joint.
glm::dmat4 blend(const Influences& influences, const std::vector<glm::dmat4>& joints, size_t vertex) {
  glm::dmat4 sum(0);
  double total = 0;
  for (size_t set = 0; set < influences.sets; ++set) {
    for (int k = 0; k < 4; ++k) {
      const double weight = influences.weights[set][vertex][k];
      sum += weight * joints[influences.joints[set][4 * vertex + static_cast<size_t>(k)]];
      total += weight;
    }
  }
  return total > 0 ? sum / total : joints[influences.joints[0][4 * vertex]];
}

/// The matrix normals transform by: the cofactors, which is det(M) times the inverse transpose.
glm::dmat3 cofactors(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

glm::vec3 unit_or(glm::dvec3 v, glm::vec3 fallback) {
  const double length = std::sqrt(glm::dot(v, v));
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : fallback;
}

/// Moves the vertices; returns how many of them were mirrored.
size_t skin_vertices(const Influences& influences, const std::vector<glm::dmat4>& joints, Geometry& geometry) {
  size_t mirrored = 0;
  for (size_t i = 0; i < geometry.positions.size(); ++i) {
    const glm::dmat4 matrix = blend(influences, joints, i);
    const glm::dmat3 linear(matrix);
    const double sign = glm::determinant(linear) < 0 ? -1 : 1;
    mirrored += sign < 0;
    geometry.positions[i] = glm::vec3(matrix * glm::dvec4(glm::dvec3(geometry.positions[i]), 1));
    if (!geometry.normals.empty()) {
      const glm::dvec3 normal = sign * cofactors(linear) * glm::dvec3(geometry.normals[i]);
      geometry.normals[i] = unit_or(normal, geometry.normals[i]);
    }
    if (!geometry.tangents.empty()) {
      const glm::vec3 old(geometry.tangents[i]);
      const glm::vec3 tangent = unit_or(linear * glm::dvec3(old), old);
      geometry.tangents[i] = glm::vec4(tangent, static_cast<float>(sign) * geometry.tangents[i].w);
    }
  }
  return mirrored;
}

void check_finite(Importer& importer, const Geometry& geometry) {
  for (const glm::vec3& p : geometry.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      importer.fail(geometry.name, "skinned positions are not finite");
    }
  }
}

}  // namespace

void apply_skin(Importer& importer, int mesh_index, int node, Mesh& mesh) {
  const int skin = importer.model().nodes[static_cast<size_t>(node)].skin;
  const std::vector<glm::dmat4> joints = joint_matrices(importer, skin);
  const tinygltf::Mesh& source = importer.model().meshes[static_cast<size_t>(mesh_index)];
  for (Geometry& geometry : mesh.geometries) {
    const size_t primitive = static_cast<size_t>(std::stoul(geometry.name.substr(geometry.name.rfind('[') + 1)));
    const Influences influences = read_influences(importer, source.primitives[primitive], geometry.name,
                                                  geometry.positions.size(), joints.size());
    if (influences.sets == 0) importer.fail(geometry.name, "is used with a skin but has no JOINTS_0 and WEIGHTS_0");
    const size_t mirrored = skin_vertices(influences, joints, geometry);
    check_finite(importer, geometry);
    // A mirroring baked into vertices turns the winding; swapping two indices turns it back (CU-03).
    if (2 * mirrored > geometry.positions.size()) {
      for (size_t i = 0; i < geometry.indices.size(); i += 3)
        std::swap(geometry.indices[i + 1], geometry.indices[i + 2]);
    }
  }
  importer.warn(fmt::format("skins[{}]: shown in the pose its joint nodes are stored in", skin));
}

}  // namespace rayloom::scenes::gltf
