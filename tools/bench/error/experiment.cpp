#include <rayloom/tools/bench/error/experiment.h>

#include <rayloom/base/progress.h>

#include <map>
#include <memory>

namespace rayloom::bench {
namespace {

shaders::RenderOptions render_options(const ErrorSettings& settings, shaders::Estimator estimator) {
  shaders::RenderOptions options;
  options.width = settings.width, options.height = settings.height;
  options.max_bounces = settings.max_bounces;
  options.estimator = estimator;
  return options;
}

/// Counts pixels' samples; shows nothing when told so.
class SampleProgress {
 public:
  SampleProgress(const std::string& label, const ErrorSettings& settings, uint64_t spp, bool show)
      : pixels_(uint64_t{settings.width} * settings.height) {
    if (show) progress_ = std::make_unique<Progress>(label, pixels_ * spp, "samples");
  }
  void operator()(uint64_t samples) const {
    if (progress_) progress_->advance(pixels_ * samples);
  }

 private:
  uint64_t pixels_;
  std::unique_ptr<Progress> progress_;
};

Reference obtain_reference(shaders::Renderer& renderer, const ErrorSettings& settings, ReferenceFile& file,
                           SceneErrors& result, bool show_progress) {
  result.reference_key = reference_key(renderer, result.scene, settings.reference_spp);
  if (auto kept = file.find(result.reference_key)) {
    result.reference_cached = true;
    return *kept;
  }
  const SampleProgress progress("reference of " + result.scene, settings, settings.reference_spp, show_progress);
  Reference reference = render_reference(renderer, settings.reference_spp, std::cref(progress));
  file.add(result.reference_key, reference);
  return reference;
}

/// One renderer an estimator: samplers and seeds share it.
class Renderers {
 public:
  Renderers(const scenes::Scene& scene, const ErrorSettings& settings) : scene_(scene), settings_(settings) {}

  shaders::Renderer& of(shaders::Estimator estimator) {
    auto& slot = renderers_[estimator];
    if (!slot) slot = std::make_unique<shaders::Renderer>(scene_, render_options(settings_, estimator));
    return *slot;
  }

 private:
  const scenes::Scene& scene_;
  const ErrorSettings& settings_;
  std::map<shaders::Estimator, std::unique_ptr<shaders::Renderer>> renderers_;
};

/// Returns the last picture.
shaders::Picture measure_seed(shaders::Renderer& renderer, uint32_t seed, ErrorCurve& curve, const Reference& reference,
                              const SampleProgress& progress) {
  renderer.restart(seed, curve.configuration.sampler);
  double seconds = 0;
  shaders::Picture picture;
  curve.seeds.emplace_back();
  for (const uint32_t spp : curve.spp) {
    seconds += render_range(renderer, spp, std::cref(progress));
    picture = renderer.picture();
    curve.seeds.back().push_back({picture_error(picture, reference), flip_error(picture, reference), seconds});
  }
  return picture;
}

void measure_curves(const scenes::Scene& scene, const ErrorSettings& settings, const Reference& reference,
                    Renderers& renderers, SceneErrors& result, bool show_progress) {
  const size_t count = settings.configurations.size();
  const SampleProgress progress(scene.name, settings, uint64_t{settings.seeds} * count * settings.spp.back(),
                                show_progress);
  std::vector<SeedSpread> spreads(count);
  for (const Configuration& configuration : settings.configurations) {
    result.curves.push_back({configuration, settings.spp, {}, {}});
  }
  for (uint32_t seed = 1; seed <= settings.seeds; ++seed) {
    for (size_t k = 0; k < count; ++k) {
      const size_t i = seed % 2 ? k : count - 1 - k;
      ErrorCurve& curve = result.curves[i];
      shaders::Renderer& renderer = renderers.of(curve.configuration.estimator);
      spreads[i].add(measure_seed(renderer, seed, curve, reference, progress));
    }
  }
  for (size_t i = 0; i < count; ++i) result.curves[i].bias = spreads[i].squared_bias(reference);
}

}  // namespace

SceneErrors measure_scene(const scenes::Scene& scene, const ErrorSettings& settings, ReferenceFile& references,
                          bool show_progress) {
  SceneErrors result;
  result.scene = scene.name;
  result.reference_spp = settings.reference_spp;
  Renderers renderers(scene, settings);
  const Reference reference =
      obtain_reference(renderers.of(shaders::Estimator::mis), settings, references, result, show_progress);
  result.reference_error = reference_error(reference);
  result.reference_flip = reference_flip_error(reference);
  result.hdr = has_hdr(reference);
  measure_curves(scene, settings, reference, renderers, result, show_progress);
  return result;
}

}  // namespace rayloom::bench
