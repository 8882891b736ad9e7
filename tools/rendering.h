#pragma once

// A renderer under way: set up from the command line's options, run in batches with progress, stopped by Ctrl-C.

#include <rayloom/shaders/renderer.h>
#include <rayloom/tools/render_options.h>

#include <chrono>

namespace rayloom::tools {

/// A renderer for `options`. `tracer`: null for the native one; a tracer makes warps, whatever the mode.
shaders::Renderer make_renderer(const scenes::Scene& scene, const RenderOptions& options, Tracer* tracer = nullptr);

/// Renders all samples, in batches of about a third of a second. Returns false when Ctrl-C ended it early, with the
/// samples of renderer.samples() done.
bool render_samples(shaders::Renderer& renderer, const RenderOptions& options, const CommonOptions& common,
                    const std::string& label);

/// Loads the scene, puts it under the sky the options ask for, and prints its warnings to standard error unless quiet.
scenes::Scene load_scene(const RenderOptions& options, const CommonOptions& common);

/// What was rendered and how fast, for reports.
Json to_json(const shaders::Renderer& renderer, uint64_t render_time_ns);

/// Nanoseconds since it was made.
class Stopwatch {
 public:
  uint64_t ns() const {
    return static_cast<uint64_t>(std::chrono::nanoseconds(std::chrono::steady_clock::now() - begin_).count());
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace rayloom::tools
