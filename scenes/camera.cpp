#include "camera.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace rayloom::scenes {
namespace {

constexpr float pi = 3.14159265f;
constexpr float default_yfov = pi / 4;

void store(glm::vec3 v, float* out) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }
glm::vec3 load(const float* v) { return {v[0], v[1], v[2]}; }

/// Scaled by the largest component first, so that no length over- or underflows.
std::optional<glm::vec3> unit(glm::vec3 v) {
  const float largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
  v /= largest;
  return v / std::sqrt(glm::dot(v, v));
}

float parse_float(std::string_view text, std::string_view spec) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value)) return value;
  throw UsageError(fmt::format("--camera '{}': '{}' is not a number", spec, text));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

glm::vec3 parse_vec3(std::string_view text, std::string_view spec) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw UsageError(fmt::format("--camera '{}': '{}' is not x,y,z", spec, text));
  return {parse_float(parts[0], spec), parse_float(parts[1], spec), parse_float(parts[2], spec)};
}

struct Spec {
  std::optional<glm::vec3> eye, at;
  glm::vec3 up{0, 1, 0};
  float fov_degrees = 45;
  std::optional<float> ortho;
};

void parse_part(std::string_view part, std::string_view whole, Spec& spec) {
  const size_t equals = part.find('=');
  const std::string_view key = part.substr(0, equals), value = part.substr(equals == part.npos ? 0 : equals + 1);
  if (key == "eye") {
    spec.eye = parse_vec3(value, whole);
  } else if (key == "at") {
    spec.at = parse_vec3(value, whole);
  } else if (key == "up") {
    spec.up = parse_vec3(value, whole);
  } else if (key == "fov") {
    spec.fov_degrees = parse_float(value, whole);
  } else if (key == "ortho") {
    spec.ortho = parse_float(value, whole);
  } else {
    throw UsageError(fmt::format("--camera '{}': '{}' is none of eye, at, up, fov, ortho", whole, key));
  }
}

SceneCamera camera_from_spec(std::string_view text) {
  Spec spec;
  for (const std::string_view part : split(text, ';')) {
    if (!part.empty()) parse_part(part, text, spec);
  }
  if (!spec.eye || !spec.at) throw UsageError(fmt::format("--camera '{}': eye and at are needed", text));
  if (!(spec.fov_degrees > 0 && spec.fov_degrees < 180)) {
    throw UsageError(fmt::format("--camera '{}': fov must be above 0 and below 180 degrees", text));
  }
  SceneCamera camera = look_at(*spec.eye, *spec.at, spec.up, spec.fov_degrees * (pi / 180));
  if (!spec.ortho) return camera;
  if (!(*spec.ortho > 0)) throw UsageError(fmt::format("--camera '{}': ortho must be above 0", text));
  camera.kind = SceneCamera::Kind::orthographic;
  camera.xmag = camera.ymag = *spec.ortho;
  return camera;
}

[[noreturn]] void fail_unknown(const Scene& scene, std::string_view spec) {
  std::string known;
  for (size_t i = 0; i < scene.cameras.size(); ++i) known += fmt::format(" {}='{}'", i, scene.cameras[i].name);
  throw UsageError(
      fmt::format("--camera '{}': no such camera; the scene has{}", spec, known.empty() ? " none" : known));
}

const SceneCamera& named_camera(const Scene& scene, std::string_view spec) {
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.name == spec) return camera;
  }
  size_t index = 0;
  const auto [end, error] = std::from_chars(spec.data(), spec.data() + spec.size(), index);
  if (error != std::errc() || end != spec.data() + spec.size() || index >= scene.cameras.size()) {
    fail_unknown(scene, spec);
  }
  return scene.cameras[index];
}

/// How far from the box's centre, along `backward`, all corners are inside the picture.
float framing_distance(glm::vec3 half, const SceneCamera& camera, float tan_x, float tan_y) {
  float distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 offset(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y, corner & 4 ? half.z : -half.z);
    const float depth = glm::dot(offset, camera.backward);
    distance = std::max(distance, depth + std::fabs(glm::dot(offset, camera.right)) / tan_x);
    distance = std::max(distance, depth + std::fabs(glm::dot(offset, camera.up)) / tan_y);
  }
  return distance;
}

}  // namespace

CameraRays camera_rays(const SceneCamera& camera, uint32_t width, uint32_t height) {
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const bool orthographic = camera.kind == SceneCamera::Kind::orthographic;
  const float half_height = orthographic ? std::fabs(camera.ymag) : det::tan(camera.yfov / 2);
  const glm::vec3 horizontal = camera.right * (2 * half_height * aspect), vertical = camera.up * (2 * half_height);
  const glm::vec3 center = orthographic ? camera.position : camera.position - camera.backward;
  CameraRays rays;
  rays.orthographic = orthographic;
  store(camera.position, rays.origin);
  store(center - horizontal / 2.0f - vertical / 2.0f, rays.lower_left);
  store(horizontal, rays.horizontal);
  store(vertical, rays.vertical);
  store(-camera.backward, rays.forward);
  return rays;
}

CameraRay camera_ray(const CameraRays& rays, float s, float t) {
  const glm::vec3 point = load(rays.lower_left) + s * load(rays.horizontal) + t * load(rays.vertical);
  if (rays.orthographic) return {point, load(rays.forward)};
  const glm::vec3 direction = point - load(rays.origin);
  return {load(rays.origin), direction / std::sqrt(glm::dot(direction, direction))};
}

SceneCamera look_at(glm::vec3 eye, glm::vec3 at, glm::vec3 up, float yfov_radians) {
  const auto backward = unit(eye - at);
  if (!backward) throw UsageError("camera: eye and at must be different points");
  const auto right = unit(glm::cross(unit(up).value_or(glm::vec3(0)), *backward));
  if (!right) throw UsageError("camera: up must not be zero or parallel to the view");
  SceneCamera camera;
  camera.position = eye;
  camera.backward = *backward;
  camera.right = *right;
  camera.up = glm::cross(*backward, *right);
  camera.yfov = yfov_radians;
  return camera;
}

SceneCamera framing_camera(const Scene& scene, float aspect) {
  const Bounds bounds = world_bounds(scene);
  const glm::vec3 center = bounds.empty() ? glm::vec3(0) : bounds.min * 0.5f + bounds.max * 0.5f;
  const glm::vec3 half = bounds.empty() ? glm::vec3(1) : bounds.max * 0.5f - bounds.min * 0.5f;
  SceneCamera camera = look_at(glm::vec3(0.4f, 0.3f, 1), glm::vec3(0), glm::vec3(0, 1, 0), default_yfov);
  const float tan_y = det::tan(default_yfov / 2), tan_x = tan_y * aspect;
  const float distance = framing_distance(half, camera, tan_x, tan_y);
  camera.position = center + camera.backward * (distance > 0 ? 1.05f * distance : 1.0f);
  camera.name = "frame";
  return camera;
}

SceneCamera choose_camera(const Scene& scene, std::string_view spec, float aspect) {
  if (spec.empty() && !scene.cameras.empty()) return scene.cameras.front();
  if (spec.empty() || spec == "frame") return framing_camera(scene, aspect);
  if (spec.find('=') != std::string_view::npos) return camera_from_spec(spec);
  return named_camera(scene, spec);
}

}  // namespace rayloom::scenes
