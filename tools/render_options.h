#pragma once

// The options that decide a picture, shared by render and simulate.

#include <rayloom/runtime/dispatch.h>
#include <rayloom/shaders/sampler_kind.h>
#include <rayloom/tools/cli_values.h>
#include <rayloom/tools/image.h>
#include <rayloom/tools/report.h>

#include <optional>
#include <string>
#include <vector>

namespace rayloom::tools {

struct RenderOptions {
  std::string scene;
  std::string shader = "path_tracer";
  uint64_t spp = 16;
  Size size{960, 540};
  std::string camera;       ///< as scenes::choose_camera takes it
  std::string environment;  ///< as apply_environment takes it
  double environment_scale = 1;
  std::optional<Pixel> pixel;
  uint64_t seed = 0;
  shaders::SamplerKind sampler = shaders::SamplerKind::owen_sobol;
  uint64_t threads = 0;
  std::string isa;                ///< empty: the fastest
  std::vector<std::string> aovs;  ///< channels in full, in the order asked for
  uint64_t max_bounces = 8;
  ExecutionMode mode = ExecutionMode::automatic;
};

/// Adds SCENE and every option above.
void add_render_options(CLI::App& sub, RenderOptions& options);

/// Checks what one option says about another, and chooses the instruction set for the whole process.
void apply_render_options(const RenderOptions& options);

/// The rayloom command that makes the same picture: scene and options that decide its bits, not threads, instruction
/// set, mode or output, so that the same picture is the same file.
std::string picture_command(const RenderOptions& options);

/// What a picture's header says of its making.
Metadata picture_metadata(const RenderOptions& options, uint64_t samples);

/// The options as they stand in reports. `used`: the execution mode that was really chosen.
Json to_json(const RenderOptions& options, ExecutionMode used);

}  // namespace rayloom::tools
