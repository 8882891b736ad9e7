#pragma once

// glTF 2.0 import: .gltf and .glb, read through tinygltf after every rule the importer relies on has been checked.
//
// What is read: triangles, strips and fans with every attribute of scene.h, node trees, cameras, materials, textures,
// KHR_lights_punctual, KHR_materials_emissive_strength, KHR_texture_transform, KHR_mesh_quantization. Skins stand as
// their joint nodes are stored and morph targets at their default weights, both with a warning. Points and lines are
// skipped with a warning. Any other extension is a warning when used and an error when required.

#include <rayloom/scenes/scene.h>

#include <span>

namespace rayloom::scenes {

/// InputError naming the file, the JSON object and the rule. Images are not decoded, but external ones must exist.
Scene load_gltf(const std::string& path);

/// The same from memory. `name` stands for the file in messages; `directory` is where relative URIs are looked up.
Scene load_gltf_bytes(std::span<const std::byte> bytes, const std::string& name, const std::string& directory);

}  // namespace rayloom::scenes
