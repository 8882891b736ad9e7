#pragma once

// What a scene is: plain data, filled by the glTF loader (scenes/gltf) and the procedural scenes (scenes/procedural),
// read by shaders/scene_to_device. Right-handed axes, metres, y up, as in glTF 2.0.
//
// A mesh is one bottom-level structure and a geometry of it one DXR geometry; an instance is one TLAS entry. Nodes that
// share a mesh become instances of one mesh. Counter-clockwise triangles face forward, which is DXR's "clockwise" in
// its left-handed axes: the same test dot(cross(v1 - v0, v2 - v0), direction) < 0, in object space. A mirrored node
// keeps the same object-space side in front (CU-02, RP-28), so no instance flag is ever needed for it.

#include <rayloom/scenes/image.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace rayloom::scenes {

/// Row-major 3x4 affine map, translation in column 3: DXR's FLOAT[3][4].
using Transform3x4 = std::array<float, 12>;
inline constexpr Transform3x4 identity_transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

inline constexpr uint32_t no_texture = ~0u;
inline constexpr uint32_t no_image = ~0u;

enum class Wrap : uint8_t { repeat, mirrored_repeat, clamp_to_edge };
enum class Filter : uint8_t { nearest, linear };

/// An image with a sampler. There are no mip levels; of glTF's filters the magnification filter counts.
struct Texture {
  uint32_t image = 0;  ///< no_image: the file names none we can read, and no material refers to the texture
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;
  std::string name;
};

/// Which texture, which coordinates. KHR_texture_transform is folded into the two rows: u' = dot(row_u, (u, v, 1)).
struct TextureRef {
  uint32_t texture = no_texture;
  uint32_t uv_set = 0;  ///< 0 or 1
  glm::vec3 row_u{1, 0, 0};
  glm::vec3 row_v{0, 1, 0};

  bool exists() const { return texture != no_texture; }
  glm::vec2 map(glm::vec2 uv) const {
    return {row_u.x * uv.x + row_u.y * uv.y + row_u.z, row_v.x * uv.x + row_v.y * uv.y + row_v.z};
  }
};

enum class AlphaMode : uint8_t { opaque, mask, blend };

/// glTF 2.0 metallic-roughness material. Colours are linear; base colour and emissive textures are sRGB, all other
/// textures linear (sample them so: see texture.h).
struct Material {
  std::string name;
  glm::vec4 base_color{1, 1, 1, 1};
  TextureRef base_color_texture;          ///< times base_color; alpha is the coverage
  float metallic = 1;                     ///< 0..1
  float roughness = 1;                    ///< 0..1, perceptual: GGX alpha is its square
  TextureRef metallic_roughness_texture;  ///< green times roughness, blue times metallic
  TextureRef normal_texture;
  float normal_scale = 1;
  TextureRef occlusion_texture;  ///< red
  float occlusion_strength = 1;
  glm::vec3 emissive{0, 0, 0};  ///< radiance: emissiveFactor * KHR_materials_emissive_strength
  TextureRef emissive_texture;  ///< times emissive
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  ///< AlphaMode::mask: a hit counts where alpha >= cutoff
  bool double_sided = false;  ///< false: the back is culled by raster engines; a tracer may still show it

  bool emits() const { return emissive.x > 0 || emissive.y > 0 || emissive.z > 0; }
};

/// A triangle list. `positions` and `indices` are never empty; every other array is empty or as long as `positions`.
struct Geometry {
  std::string name;
  uint32_t material = 0;             ///< always valid
  std::vector<glm::vec3> positions;  ///< finite
  std::vector<uint32_t> indices;     ///< three a triangle, all below positions.size()
  std::vector<glm::vec3> normals;    ///< unit; empty: shade with the geometric normal
  std::vector<glm::vec4> tangents;   ///< unit xyz, w = +-1: bitangent = w * cross(normal, tangent)
  std::vector<glm::vec2> uv0;
  std::vector<glm::vec2> uv1;
  std::vector<glm::vec4> colors;  ///< linear, times the base colour

  uint64_t triangle_count() const { return indices.size() / 3; }
};

struct Sphere {
  glm::vec3 center{0, 0, 0};
  float radius = 1;
};

/// Spheres with one material, for an intersection shader over their boxes.
struct SphereSet {
  std::string name;
  uint32_t material = 0;  ///< opaque alpha mode
  std::vector<Sphere> spheres;
};

/// One bottom-level structure: either triangles or spheres, since DXR does not mix them. Exactly one list is filled.
struct Mesh {
  std::string name;
  std::vector<Geometry> geometries;
  std::vector<SphereSet> sphere_sets;

  bool procedural() const { return !sphere_sets.empty(); }
};

struct Instance {
  uint32_t mesh = 0;
  Transform3x4 transform = identity_transform;  ///< object to world, composed in double; may mirror or be singular
  std::string name;                             ///< of the node
  std::string path;                             ///< names from the root, "Root/Arm/Hand"; unnamed nodes are "#index"
};

/// KHR_lights_punctual in world space.
struct Light {
  enum class Kind : uint8_t { point, spot, directional };
  Kind kind = Kind::point;
  std::string name;
  glm::vec3 position{0, 0, 0};
  glm::vec3 direction{0, 0, -1};  ///< unit, the way the light travels (spot, directional)
  glm::vec3 intensity{1, 1, 1};   ///< colour times intensity: candela (point, spot), lux (directional)
  float range = std::numeric_limits<float>::infinity();  ///< metres; no light beyond (point, spot)
  float cos_inner_cone = 1;                              ///< spot: full intensity inside
  float cos_outer_cone = 0.70710678f;                    ///< spot: dark outside
};

/// A camera of the file in world space. `right`, `up`, `backward` are unit and orthogonal; it looks along -backward.
struct SceneCamera {
  enum class Kind : uint8_t { perspective, orthographic };
  Kind kind = Kind::perspective;
  std::string name;
  glm::vec3 position{0, 0, 0};
  glm::vec3 right{1, 0, 0};
  glm::vec3 up{0, 1, 0};
  glm::vec3 backward{0, 0, 1};
  float yfov = 0.7853982f;  ///< perspective: full vertical angle in radians, in (0, pi)
  float aspect = 0;         ///< perspective: width / height; 0: that of the picture
  float xmag = 1;           ///< orthographic: half width in metres
  float ymag = 1;           ///< orthographic: half height in metres
  float znear = 0;
  float zfar = std::numeric_limits<float>::infinity();
};

/// What a ray that hits nothing sees.
struct Environment {
  enum class Kind : uint8_t { none, constant, gradient, image };
  Kind kind = Kind::none;
  glm::vec3 zenith{0, 0, 0};   ///< radiance straight up; the colour itself when constant
  glm::vec3 horizon{0, 0, 0};  ///< gradient: radiance at direction.y = 0, linear in |direction.y| to either pole
  glm::vec3 nadir{0, 0, 0};    ///< gradient: radiance straight down
  uint32_t image = 0;          ///< image: latitude-longitude, v = 0 up, u = 0.5 + atan2(x, -z) / 2 pi, linear
  float scale = 1;             ///< image: times its pixels
};

struct Bounds {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  void add(glm::vec3 point) { min = glm::min(min, point), max = glm::max(max, point); }
};

struct Scene {
  std::string name;  ///< the path or the procedural name with its parameters, as given
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;  ///< never empty
  std::vector<Texture> textures;
  std::vector<std::shared_ptr<const Image>> images;  ///< pixels are decoded when first read
  std::vector<Light> lights;
  std::vector<SceneCamera> cameras;
  Environment environment;
  std::vector<std::string> extensions_used;  ///< as the file names them
  std::vector<std::string> warnings;         ///< what was skipped or approximated, one sentence each
};

/// World-space bounds of all instances' vertices and spheres.
Bounds world_bounds(const Scene& scene);

/// A glTF file (.gltf, .glb: what the bytes are decides) or a procedural scene "name" or "name:key=value,key=value".
/// InputError when it is neither, or the file breaks a rule; see load_gltf.h and procedural/registry.h.
Scene load_scene(const std::string& file_or_name);

}  // namespace rayloom::scenes
