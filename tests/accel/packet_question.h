#pragma once

// What tests ask of packets; without anything that Highway's re-inclusion could compile per target.

#include <rayloom/accel/layout.h>
#include <rayloom/accel/ray.h>

namespace rayloom::accel::test {

inline constexpr uint32_t most_packet_rays = 32;

struct PacketQuestion {
  const Ray* rays;
  float t_far[most_packet_rays];
  StructureHeader header;
  Node8 node;
  PlainTriangleLeaf leaf;
};

}  // namespace rayloom::accel::test
