#pragma once

// A picture made by the simulated GPU: captured with the recording tracer, replayed, and read back from the memory the
// replayed shaders stored to.

#include <rayloom/hwmodel/replay.h>
#include <rayloom/tools/rendering.h>

namespace rayloom::tools {

struct SimulatedPicture {
  Image picture;  ///< R G B A of what the replay stored, then the channels asked for, traced by the recording tracer
  Image cycles;   ///< hw.cycles: clocks a pixel's lane did or awaited its own work, summed over launches
  hwmodel::GpuStats stats;
};

/// Throws what hwmodel::replay throws; Interrupted at Ctrl-C.
SimulatedPicture simulate_picture(const scenes::Scene& scene, const RenderOptions& options,
                                  const hwmodel::GpuConfig& config, const CommonOptions& common);

}  // namespace rayloom::tools
