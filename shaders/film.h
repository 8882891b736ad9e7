#pragma once

// What every program writes: sums over samples, a pixel each. Sums are in double and samples are added in order, so the
// bits do not depend on how the samples were split into batches.

#include <rayloom/runtime/buffer_views.h>
#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

struct PixelSums {
  glm::dvec3 color{0};
  glm::dvec3 squares{0};
  double alpha = 0;

  void add(float3 sample, float coverage) {
    const glm::dvec3 c(sample);
    color += c;
    squares += c * c;
    alpha += double{coverage};
  }
};

/// Root arguments of every program's dispatch: a window of the picture and a range of samples.
struct FilmArguments {
  RWStructuredBuffer<PixelSums> pixels;  ///< of the window, row by row
  uint2 window_origin{0, 0};
  uint2 window_size{0, 0};
  uint32_t first_sample = 0;
  uint32_t sample_count = 0;
  uint32_t seed = 0;
  SamplerKind sampler = SamplerKind::owen_sobol;

  uint2 pixel(uint3 launch_index) const { return window_origin + uint2(launch_index); }
  uint64_t slot(uint3 launch_index) const { return uint64_t{launch_index.y} * window_size.x + launch_index.x; }
};

/// A ray generation shader's loop: add(sampler, pixel, sums) for each sample of the launch's pixel.
template <class AddSample>
void add_samples(RayGenContext& ctx, const AddSample& add) {
  const auto film = ctx.GlobalRoot<FilmArguments>();
  const uint2 pixel = film.pixel(ctx.DispatchRaysIndex());
  PixelSums sums = film.pixels[film.slot(ctx.DispatchRaysIndex())];
  for (uint32_t i = 0; i < film.sample_count; ++i)
    add(Sampler(pixel, film.first_sample + i, film.seed, film.sampler), pixel, sums);
  film.pixels[film.slot(ctx.DispatchRaysIndex())] = sums;
}

}  // namespace rayloom::shaders
