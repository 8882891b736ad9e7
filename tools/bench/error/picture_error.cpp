#include <rayloom/tools/bench/error/picture_error.h>

#include <rayloom/tools/flip.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayloom::bench {
namespace {

double sum(glm::dvec3 v) { return v.x + v.y + v.z; }

glm::dvec3 relative_weight(glm::dvec3 r) { return 1.0 / (r * r + 0.01); }

/// From the sum of squares and each pixel's sum of relative squares over the channels.
PictureError with_means(double squared, std::vector<double> relative) {
  std::sort(relative.begin(), relative.end());
  const size_t kept = relative.size() - (relative.size() + 999) / 1000;
  const double inner = std::accumulate(relative.begin(), relative.begin() + static_cast<std::ptrdiff_t>(kept), 0.0);
  const double all = std::accumulate(relative.begin() + static_cast<std::ptrdiff_t>(kept), relative.end(), inner);
  const double samples = 3.0 * static_cast<double>(relative.size());
  return {squared / samples, all / samples, kept > 0 ? inner / (3.0 * static_cast<double>(kept)) : 0};
}

template <class Pixel>
tools::Image to_image(uint32_t width, uint32_t height, const std::vector<Pixel>& pixels) {
  tools::Image image{width, height, {}, {}};
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    for (const Pixel& pixel : pixels) values.push_back(pixel[c]);
    image.channels.push_back({std::string(1, "RGB"[c]), std::move(values)});
  }
  return image;
}

double mean_flip(const tools::Image& image, const tools::Image& reference, tools::FlipMode mode) {
  tools::FlipOptions options;
  options.mode = mode;
  return tools::compute_flip(image, "picture", reference, "reference", options).mean;
}

FlipError flip_error(const tools::Image& image, const tools::Image& reference, bool with_hdr) {
  return {mean_flip(image, reference, tools::FlipMode::ldr),
          with_hdr ? mean_flip(image, reference, tools::FlipMode::hdr) : 0};
}

std::vector<glm::vec3> mean_pixels(const Reference& reference) {
  std::vector<glm::vec3> pixels;
  for (size_t i = 0; i < reference.pixel_count(); ++i) pixels.emplace_back(reference.pixel(i));
  return pixels;
}

}  // namespace

PictureError picture_error(const shaders::Picture& picture, const Reference& reference) {
  double total = 0;
  std::vector<double> relative;
  for (size_t i = 0; i < reference.pixel_count(); ++i) {
    const glm::dvec3 r = reference.pixel(i), d = glm::dvec3(picture.rgba[i]) - r;
    const glm::dvec3 squared = d * d - glm::dvec3(reference.own_variance[i]);
    total += sum(squared);
    relative.push_back(sum(squared * relative_weight(r)));
  }
  return with_means(total, std::move(relative));
}

PictureError reference_error(const Reference& reference) {
  double squared = 0;
  std::vector<double> relative;
  for (size_t i = 0; i < reference.pixel_count(); ++i) {
    const glm::dvec3 variance(reference.own_variance[i]);
    squared += sum(variance);
    relative.push_back(sum(variance * relative_weight(reference.pixel(i))));
  }
  return with_means(squared, std::move(relative));
}

bool has_hdr(const Reference& reference) {
  for (size_t i = 0; i < reference.pixel_count(); ++i) {
    const glm::dvec3 r = reference.pixel(i);
    if (std::max({r.x, r.y, r.z}) > 1) return true;
  }
  return false;
}

FlipError flip_error(const shaders::Picture& picture, const Reference& reference) {
  const tools::Image image = to_image(picture.width, picture.height, picture.rgba);
  return flip_error(image, to_image(reference.width, reference.height, mean_pixels(reference)), has_hdr(reference));
}

FlipError reference_flip_error(const Reference& reference) {
  return flip_error(to_image(reference.width, reference.height, reference.half[0]),
                    to_image(reference.width, reference.height, reference.half[1]), has_hdr(reference));
}

void SeedSpread::add(const shaders::Picture& picture) {
  sums_.resize(picture.rgba.size(), glm::dvec3(0));
  squares_.resize(picture.rgba.size(), glm::dvec3(0));
  for (size_t i = 0; i < sums_.size(); ++i) {
    const glm::dvec3 value(picture.rgba[i]);
    sums_[i] += value, squares_[i] += value * value;
  }
  ++count_;
}

Bias SeedSpread::squared_bias(const Reference& reference) const {
  double total = 0, squares = 0;
  for (size_t i = 0; i < sums_.size(); ++i) {
    const glm::dvec3 r = reference.pixel(i), mean = sums_[i] / count_, d = mean - r;
    const glm::dvec3 variance_of_mean = (squares_[i] - sums_[i] * mean) / (count_ * (count_ - 1));
    const double rest =
        sum((d * d - variance_of_mean - glm::dvec3(reference.own_variance[i])) * relative_weight(r)) / 3;
    total += rest, squares += rest * rest;
  }
  const auto pixels = static_cast<double>(sums_.size());
  const double mean = total / pixels;
  return {mean, std::sqrt(std::max(squares / pixels - mean * mean, 0.0) / pixels)};
}

}  // namespace rayloom::bench
