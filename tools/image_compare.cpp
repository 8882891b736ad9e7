#include <rayloom/tools/image_compare.h>

#include <rayloom/base/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// |x-r|; 0 for equal samples, NaNs among them, and infinite for incomparable ones.
double distance(float x, float r) {
  if (x == r || (std::isnan(x) && std::isnan(r))) return 0;
  if (!std::isfinite(x) || !std::isfinite(r)) return infinity;
  return std::abs(static_cast<double>(x) - static_cast<double>(r));
}
double distance(uint32_t x, uint32_t r) { return x == r ? 0 : 1; }

double relative_scale(float r) { return static_cast<double>(r) * static_cast<double>(r) + 0.01; }
double relative_scale(uint32_t) { return 1; }

void add_sample(ChannelError& error, double d, double scale) {
  ++error.samples;
  if (d == 0) return;
  ++error.different;
  error.largest = std::max(error.largest, d);
  if (d == infinity) {
    ++error.incomparable;
    return;
  }
  error.sum_squared += d * d;
  error.sum_relative += d * d / scale;
  error.sum_absolute += d;
}

template <class Value>
bool same_bits(const std::vector<Value>& x, const std::vector<Value>& r) {
  const auto same = [](Value a, Value b) { return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b); };
  return std::equal(x.begin(), x.end(), r.begin(), r.end(), same);
}

/// Calls f(x values, r values) with the type both channels have.
template <class Function>
void with_values(const Channel& x, const Channel& r, Function&& f) {
  if (x.is_id()) {
    f(x.ids(), r.ids());
  } else {
    f(x.floats(), r.floats());
  }
}

void merge(ChannelError& total, const ChannelError& part) {
  total.samples += part.samples;
  total.different += part.different;
  total.incomparable += part.incomparable;
  total.sum_squared += part.sum_squared;
  total.sum_relative += part.sum_relative;
  total.sum_absolute += part.sum_absolute;
  total.largest = std::max(total.largest, part.largest);
}

std::string channel_list(const Image& image) {
  std::string list;
  for (const Channel& channel : image.channels) list += (list.empty() ? "" : " ") + channel.name;
  return list;
}

void require_same_shape(const Image& image, const std::string& name, const Image& reference,
                        const std::string& reference_name) {
  if (image.width != reference.width || image.height != reference.height) {
    throw InputError(name, "",
                     fmt::format("is {}x{} but {} is {}x{}: pictures of different sizes cannot be compared",
                                 image.width, image.height, reference_name, reference.width, reference.height));
  }
  const auto has_twin = [&](const Channel& channel) {
    const Channel* twin = image.find(channel.name);
    return twin && twin->is_id() == channel.is_id();
  };
  if (image.channels.size() != reference.channels.size() ||
      !std::all_of(reference.channels.begin(), reference.channels.end(), has_twin)) {
    throw InputError(
        name, "",
        fmt::format("has channels ({}) but {} has ({}): pictures with different channels cannot be compared",
                    channel_list(image), reference_name, channel_list(reference)));
  }
}

ChannelError compare_channel(const Channel& x, const Channel& r) {
  ChannelError error;
  error.name = r.name;
  with_values(x, r, [&](const auto& xs, const auto& rs) {
    for (size_t i = 0; i < rs.size(); ++i) add_sample(error, distance(xs[i], rs[i]), relative_scale(rs[i]));
  });
  return error;
}

}  // namespace

std::optional<Metric> find_metric(std::string_view name) {
  for (size_t i = 0; i < std::size(metric_names); ++i) {
    if (name == metric_names[i]) return static_cast<Metric>(i);
  }
  return std::nullopt;
}

double ChannelError::value(Metric metric) const {
  if (metric == Metric::max) return largest;
  const auto mean = [&](double sum) {
    return incomparable ? infinity : samples ? sum / static_cast<double>(samples) : 0;
  };
  switch (metric) {
    case Metric::mse:
      return mean(sum_squared);
    case Metric::relmse:
      return mean(sum_relative);
    case Metric::mae:
      return mean(sum_absolute);
    default:
      return -10 * std::log10(mean(sum_squared));
  }
}

Comparison compare_images(const Image& image, const std::string& image_name, const Image& reference,
                          const std::string& reference_name) {
  require_same_shape(image, image_name, reference, reference_name);
  Comparison comparison;
  comparison.overall.name = "all";
  for (const Channel& r : reference.channels) {
    const Channel& x = *image.find(r.name);
    comparison.channels.push_back(compare_channel(x, r));
    merge(comparison.overall, comparison.channels.back());
    with_values(x, r, [&](const auto& xs, const auto& rs) { comparison.bits_equal &= same_bits(xs, rs); });
  }
  return comparison;
}

Image difference_image(const Image& image, const Image& reference) {
  Image result{reference.width, reference.height, {}, {}};
  for (const Channel& r : reference.channels) {
    std::vector<float> difference(reference.pixel_count());
    with_values(*image.find(r.name), r, [&](const auto& xs, const auto& rs) {
      for (size_t i = 0; i < rs.size(); ++i) difference[i] = static_cast<float>(distance(xs[i], rs[i]));
    });
    result.channels.push_back({r.name, std::move(difference)});
  }
  return result;
}

bool within_bound(Metric metric, double value, double bound) {
  return metric == Metric::psnr ? value >= bound : value <= bound;
}

}  // namespace rayloom::tools
