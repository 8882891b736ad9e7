#pragma once

// Cameras: from the file, from a command line, or one that shows everything; and the few numbers a ray generation
// shader needs of them.

#include <rayloom/scenes/scene.h>

#include <string_view>

namespace rayloom::scenes {

/// A plane of points in front of the camera. With s to the right and t upwards, both in [0, 1] over the picture
/// (s = (x + 0.5) / width, t = 1 - (y + 0.5) / height for the centre of pixel x, y; row 0 at the top):
/// perspective: from origin through lower_left + s * horizontal + t * vertical;
/// orthographic: from lower_left + s * horizontal + t * vertical along forward.
struct CameraRays {
  bool orthographic = false;
  float origin[3];
  float lower_left[3];
  float horizontal[3];
  float vertical[3];
  float forward[3];  ///< unit
};

struct CameraRay {
  glm::vec3 origin;
  glm::vec3 direction;  ///< unit
};

/// The picture's shape decides the aspect ratio: yfov and ymag are kept, a file's aspectRatio and xmag are not, so
/// pixels stay square. `width`, `height`: pixels, above 0.
CameraRays camera_rays(const SceneCamera& camera, uint32_t width, uint32_t height);

/// The ray through (s, t) as defined above.
CameraRay camera_ray(const CameraRays& rays, float s, float t);

/// Looks at the whole world box, a little from above, whatever the picture's shape; yfov 45 degrees.
SceneCamera framing_camera(const Scene& scene, float aspect);

/// Looks from `eye` to `at`; `up` need not be at a right angle. UsageError when eye equals at, or up is parallel to the
/// view or zero.
SceneCamera look_at(glm::vec3 eye, glm::vec3 at, glm::vec3 up, float yfov_radians);

/// A command line's --camera:
///   ""                                        the file's first camera, else framing_camera
///   "frame"                                   framing_camera
///   "2" or a name                             that camera of the file
///   "eye=x,y,z;at=x,y,z;up=x,y,z;fov=deg"     look_at; eye and at are needed, up is 0,1,0 and fov 45 by default
///   "...;ortho=half_height"                   instead of fov: orthographic, metres
/// UsageError for anything else; it lists the cameras there are.
SceneCamera choose_camera(const Scene& scene, std::string_view spec, float aspect);

}  // namespace rayloom::scenes
