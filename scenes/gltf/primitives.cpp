#include "importer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace rayloom::scenes::gltf {
namespace {

using Attributes = std::map<std::string, int>;

constexpr int f32 = TINYGLTF_COMPONENT_TYPE_FLOAT, u32 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
              u16 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, u8 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;

/// One primitive being read: where it is, and how many vertices its POSITION has.
struct PrimitiveReader {
  Importer& importer;
  const tinygltf::Primitive& source;
  std::string object;
  size_t vertex_count = 0;

  const tinygltf::Accessor& accessor(int index) const { return importer.reader.at(index); }

  /// Quantised files (KHR_mesh_quantization) may store any attribute in any type but 32-bit integers.
  void check_type(int index, const std::string& user, std::initializer_list<int> shapes,
                  std::initializer_list<int> components) const {
    const tinygltf::Accessor& a = accessor(index);
    const bool component = std::find(components.begin(), components.end(), a.componentType) != components.end() ||
                           (importer.document.quantized && a.componentType != u32);
    const bool shape = std::find(shapes.begin(), shapes.end(), a.type) != shapes.end();
    if (!shape) importer.fail(user, fmt::format("accessors[{}] has the wrong type for this attribute", index));
    if (!component) {
      importer.fail(user, fmt::format("accessors[{}] has component type {}, which this attribute must not have", index,
                                      a.componentType));
    }
  }
  void check_count(int index, const std::string& user) const {
    if (accessor(index).count == vertex_count) return;
    importer.fail(user, fmt::format("accessors[{}] has {} elements, POSITION has {}", index, accessor(index).count,
                                    vertex_count));
  }
  template <typename T>
  std::vector<T> attribute(const Attributes& attributes, const char* key, const std::string& list, int shape,
                           std::initializer_list<int> components) const {
    const auto found = attributes.find(key);
    if (found == attributes.end()) return {};
    const std::string user = fmt::format("{}.{}.{}", object, list, key);
    check_type(found->second, user, {shape}, components);
    check_count(found->second, user);
    return importer.reader.read<T>(found->second, user);
  }
  template <typename T>
  std::vector<T> attribute(const char* key, int shape, std::initializer_list<int> components) const {
    return attribute<T>(source.attributes, key, "attributes", shape, components);
  }
};

std::vector<glm::vec4> read_colors(const PrimitiveReader& reader) {
  const auto found = reader.source.attributes.find("COLOR_0");
  if (found == reader.source.attributes.end()) return {};
  if (reader.accessor(found->second).type == TINYGLTF_TYPE_VEC4) {
    return reader.attribute<glm::vec4>("COLOR_0", TINYGLTF_TYPE_VEC4, {f32, u8, u16});
  }
  std::vector<glm::vec4> colors;
  for (const glm::vec3 rgb : reader.attribute<glm::vec3>("COLOR_0", TINYGLTF_TYPE_VEC3, {f32, u8, u16})) {
    colors.push_back({rgb, 1.0f});
  }
  return colors;
}

/// Adds the morph targets' weighted differences.
void apply_morphs(const PrimitiveReader& reader, std::span<const double> weights, Geometry& geometry) {
  for (size_t t = 0; t < reader.source.targets.size() && t < weights.size(); ++t) {
    const auto weight = static_cast<float>(weights[t]);
    const std::string list = fmt::format("targets[{}]", t);
    const auto add = [&](const char* key, auto& base) {
      if (base.empty()) return;
      const auto deltas = reader.attribute<glm::vec3>(reader.source.targets[t], key, list, TINYGLTF_TYPE_VEC3, {f32});
      for (size_t i = 0; weight != 0 && i < deltas.size(); ++i) {
        for (int c = 0; c < 3; ++c) base[i][c] += weight * deltas[i][c];
      }
    };
    add("POSITION", geometry.positions);
    add("NORMAL", geometry.normals);
    add("TANGENT", geometry.tangents);
  }
}

std::vector<uint32_t> read_indices(const PrimitiveReader& reader) {
  std::vector<uint32_t> indices;
  if (reader.source.indices < 0) {
    reader.importer.budget.take(reader.vertex_count, sizeof(uint32_t), reader.object);
    indices.resize(reader.vertex_count);
    for (size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<uint32_t>(i);
    return indices;
  }
  const std::string user = reader.object + ".indices";
  const tinygltf::Accessor& accessor = reader.accessor(reader.source.indices);
  const bool integer = accessor.componentType == u8 || accessor.componentType == u16 || accessor.componentType == u32;
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !integer) {
    reader.importer.fail(user, fmt::format("accessors[{}] must be unsigned scalars", reader.source.indices));
  }
  indices = reader.importer.reader.read_uints(reader.source.indices, user);
  for (const uint32_t index : indices) {
    if (index < reader.vertex_count) continue;
    reader.importer.fail(
        user, fmt::format("index {} is out of range, the primitive has {} vertices", index, reader.vertex_count));
  }
  return indices;
}

/// Strips and fans as lists, in the order and winding of glTF 2.0, 3.7.2.1.
std::vector<uint32_t> as_triangles(const PrimitiveReader& reader, std::vector<uint32_t> v) {
  const int mode = reader.source.mode;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (v.size() % 3 == 0) return v;
    reader.importer.fail(reader.object, fmt::format("{} vertices are no whole number of triangles", v.size()));
  }
  if (v.size() < 3) reader.importer.fail(reader.object, "a strip or fan needs at least three vertices");
  reader.importer.budget.take(v.size(), 3 * sizeof(uint32_t), reader.object);
  std::vector<uint32_t> list;
  for (size_t i = 0; i + 2 < v.size(); ++i) {
    const size_t odd = i % 2;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      list.insert(list.end(), {v[i], v[i + 1 + odd], v[i + 2 - odd]});
    } else {
      list.insert(list.end(), {v[i + 1], v[i + 2], v[0]});
    }
  }
  return list;
}

glm::vec3 unit_or_zero(glm::vec3 v) {
  const float length = std::sqrt(glm::dot(v, v));
  return length > 0 && std::isfinite(length) ? v / length : glm::vec3(0);
}

/// The mean of the neighbouring faces, for vertices whose own normal has no direction.
void repair_normals(Geometry& geometry) {
  std::vector<glm::vec3> faces(geometry.positions.size(), glm::vec3(0));
  for (size_t i = 0; i < geometry.indices.size(); i += 3) {
    const uint32_t* v = &geometry.indices[i];
    const glm::vec3 a = geometry.positions[v[0]];
    const glm::vec3 face = glm::cross(geometry.positions[v[1]] - a, geometry.positions[v[2]] - a);
    for (int k = 0; k < 3; ++k) faces[v[k]] += face;
  }
  for (size_t i = 0; i < faces.size(); ++i) {
    if (geometry.normals[i] != glm::vec3(0)) continue;
    const glm::vec3 face = unit_or_zero(faces[i]);
    geometry.normals[i] = face == glm::vec3(0) ? glm::vec3(0, 1, 0) : face;
  }
}

void make_unit(const PrimitiveReader& reader, Geometry& geometry) {
  bool broken = false;
  for (glm::vec3& normal : geometry.normals) {
    normal = unit_or_zero(normal);
    broken = broken || normal == glm::vec3(0);
  }
  if (broken) {
    reader.importer.warn(reader.object + ": normals of length zero are replaced by face normals");
    repair_normals(geometry);
  }
  for (size_t i = 0; i < geometry.tangents.size(); ++i) {
    glm::vec4& tangent = geometry.tangents[i];
    glm::vec3 direction = unit_or_zero(glm::vec3(tangent));
    if (direction == glm::vec3(0)) direction = glm::vec3(1, 0, 0);
    tangent = glm::vec4(direction, tangent.w < 0 ? -1.0f : 1.0f);
  }
}

Geometry read_primitive(PrimitiveReader& reader, std::span<const double> weights) {
  const tinygltf::Primitive& source = reader.source;
  const auto position = source.attributes.find("POSITION");
  reader.vertex_count = reader.accessor(position->second).count;
  if (reader.vertex_count > 0xFFFFFFFEu) reader.importer.fail(reader.object, "more than 2^32 - 2 vertices");
  Geometry geometry;
  geometry.material = source.material >= 0 ? static_cast<uint32_t>(source.material)
                                           : static_cast<uint32_t>(reader.importer.scene.materials.size() - 1);
  geometry.name = reader.object;
  geometry.positions = reader.attribute<glm::vec3>("POSITION", TINYGLTF_TYPE_VEC3, {f32});
  geometry.normals = reader.attribute<glm::vec3>("NORMAL", TINYGLTF_TYPE_VEC3, {f32});
  geometry.tangents = reader.attribute<glm::vec4>("TANGENT", TINYGLTF_TYPE_VEC4, {f32});
  geometry.uv0 = reader.attribute<glm::vec2>("TEXCOORD_0", TINYGLTF_TYPE_VEC2, {f32, u8, u16});
  geometry.uv1 = reader.attribute<glm::vec2>("TEXCOORD_1", TINYGLTF_TYPE_VEC2, {f32, u8, u16});
  geometry.colors = read_colors(reader);
  geometry.indices = as_triangles(reader, read_indices(reader));
  apply_morphs(reader, weights, geometry);
  for (const glm::vec3& p : geometry.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      reader.importer.fail(reader.object, "morphed positions are not finite");
  }
  make_unit(reader, geometry);
  return geometry;
}

}  // namespace

Mesh import_mesh(Importer& importer, int mesh_index, std::span<const double> weights) {
  const tinygltf::Mesh& source = importer.model().meshes[static_cast<size_t>(mesh_index)];
  Mesh mesh;
  mesh.name = source.name.empty() ? fmt::format("meshes[{}]", mesh_index) : source.name;
  for (size_t i = 0; i < source.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = source.primitives[i];
    const std::string object = fmt::format("meshes[{}].primitives[{}]", mesh_index, i);
    if (!primitive.attributes.contains("POSITION")) {
      importer.warn(object + " has no POSITION and is skipped");
    } else if (primitive.mode != -1 && primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      importer.warn(object + " is made of points or lines and is skipped");
    } else {
      PrimitiveReader reader{importer, primitive, object};
      mesh.geometries.push_back(read_primitive(reader, weights));
      if (!primitive.targets.empty()) {
        importer.warn(fmt::format("meshes[{}] has morph targets: shown at their default weights", mesh_index));
      }
    }
  }
  return mesh;
}

}  // namespace rayloom::scenes::gltf
