#pragma once

// Primary rays: the scene's camera as ray generation shaders use it.

#include <rayloom/runtime/hlsl.h>
#include <rayloom/scenes/camera.h>

#include <cmath>

namespace rayloom::shaders {

struct Camera {
  scenes::CameraRays rays{};
  float3 position{0};
  uint2 size{1, 1};  ///< of the picture, in pixels

  Camera() = default;
  Camera(const scenes::SceneCamera& camera, uint2 picture_size)
      : rays(scenes::camera_rays(camera, picture_size.x, picture_size.y)),
        position(camera.position),
        size(picture_size) {}

  /// Through a point of the picture in pixels, (0, 0) its top left corner. Direction is unit, so t counts metres.
  RayDesc ray(float2 raster) const {
    const scenes::CameraRay ray =
        scenes::camera_ray(rays, raster.x / static_cast<float>(size.x), 1.0f - raster.y / static_cast<float>(size.y));
    return {ray.origin, 0, ray.direction, INFINITY};
  }
  RayDesc ray_through_centre(uint2 pixel) const { return ray(float2(pixel) + 0.5f); }
  /// Along the viewing direction, what depth buffers hold.
  float depth(float3 point) const {
    return glm::dot(point - position, float3(rays.forward[0], rays.forward[1], rays.forward[2]));
  }
};

}  // namespace rayloom::shaders
