// rayloom diff A B: how far a picture is from its reference.

#include <rayloom/base/error.h>
#include <rayloom/base/output_file.h>
#include <rayloom/tools/cli.h>
#include <rayloom/tools/cli_values.h>
#include <rayloom/tools/flip_report.h>
#include <rayloom/tools/image_compare.h>
#include <rayloom/tools/image_io.h>
#include <rayloom/tools/preview.h>
#include <rayloom/tools/report.h>

#include <limits>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* examples =
    "  rayloom diff new.exr old.exr                       exit 0 when equal, 1 when not\n"
    "  rayloom diff a.exr reference.exr --metric relmse --max 1e-3\n"
    "  rayloom diff a.exr b.exr --metric psnr --max 40    exit 1 below 40 dB\n"
    "  rayloom diff a.exr b.exr -o difference.png         where they differ\n"
    "  rayloom diff a.png b.png --metric flip -o flip.png how visibly they differ, and where\n";

struct DiffOptions {
  std::string picture, reference, output;
  Metric metric = Metric::mse;
  bool flip = false;  ///< instead of `metric`
  FlipOptions flip_options;
  std::optional<double> bound;
};

Json to_json(const ChannelError& error) {
  Json json{{"channel", error.name},
            {"samples", error.samples},
            {"different_samples", error.different},
            {"incomparable_samples", error.incomparable}};
  for (size_t m = 0; m < std::size(metric_names); ++m) json[metric_names[m]] = error.value(static_cast<Metric>(m));
  return json;
}

std::vector<std::string> table_row(const ChannelError& error) {
  std::vector<std::string> row{error.name};
  for (size_t m = 0; m < std::size(metric_names); ++m) {
    row.push_back(fmt::format("{:.6g}", error.value(static_cast<Metric>(m))));
  }
  row.push_back(with_commas(error.different));
  return row;
}

std::string to_text(const Comparison& comparison, const std::string& verdict) {
  std::vector<std::vector<std::string>> rows{{"channel", "mse", "relmse", "psnr", "mae", "max", "different"}};
  for (const ChannelError& error : comparison.channels) rows.push_back(table_row(error));
  rows.push_back(table_row(comparison.overall));
  return format_table(rows) + verdict + "\n";
}

/// The largest difference of each pixel, whatever the channel.
std::vector<float> largest_difference(const Image& difference) {
  std::vector<float> largest(difference.pixel_count());
  for (const Channel& channel : difference.channels) {
    for (size_t i = 0; i < largest.size(); ++i) largest[i] = std::max(largest[i], channel.floats()[i]);
  }
  return largest;
}

void write_difference(const std::string& path, const Image& picture, const Image& reference) {
  const Image difference = difference_image(picture, reference);
  if (!has_extension(path, ".png")) return write_exr(path, difference);
  const std::vector<float> largest = largest_difference(difference);
  write_png(path, make_heat_map(difference.width, difference.height, largest, quantile(largest, 1)), {});
}

/// What --metric names, of all channels together.
struct Measure {
  const char* name;
  double value;
  bool comparable = true;  ///< false: within no bound
};

Measure measure(const DiffOptions& options, const Comparison& comparison, const std::optional<FlipResult>& flip) {
  if (flip) return {"flip", flip->mean, flip->incomparable_pixels == 0};
  return {metric_names[static_cast<size_t>(options.metric)], comparison.overall.value(options.metric)};
}

bool keeps_bound(const DiffOptions& options, const Measure& measured) {
  return measured.comparable && (options.flip ? measured.value <= *options.bound
                                              : within_bound(options.metric, measured.value, *options.bound));
}

void write_map(const std::string& path, const Image& picture, const Image& reference,
               const std::optional<FlipResult>& flip) {
  if (path.empty()) return;
  flip ? write_flip_map(path, *flip) : write_difference(path, picture, reference);
}

int run_diff(const DiffOptions& options, const CommonOptions& common) {
  if (options.flip_options.mode && !options.flip) throw UsageError("--flip-mode: needs --metric flip");
  if (!options.output.empty()) check_writable(options.output);
  check_json_output(common);
  const Image picture = read_image(options.picture);
  const Image reference = read_image(options.reference);
  const Comparison comparison = compare_images(picture, options.picture, reference, options.reference);
  std::optional<FlipResult> flip;
  if (options.flip) flip = compute_flip(picture, options.picture, reference, options.reference, options.flip_options);
  write_map(options.output, picture, reference, flip);

  const Measure measured = measure(options, comparison, flip);
  const bool pass = options.bound ? keeps_bound(options, measured) : comparison.overall.different == 0;
  std::string verdict = comparison.bits_equal               ? "The pictures are equal bit for bit."
                        : comparison.overall.different == 0 ? "The pictures are equal."
                                                            : "The pictures differ.";
  if (options.bound)
    verdict += fmt::format(" {} {:.6g}, bound {:.6g}: {}.", measured.name, measured.value, *options.bound,
                           pass ? "kept" : "missed");

  Json report = new_report("diff");
  report["picture"] = options.picture;
  report["reference"] = options.reference;
  report["metric"] = measured.name;
  report["value"] = measured.value;
  report["bound"] = options.bound ? Json(*options.bound) : Json();
  report["pass"] = pass;
  report["bits_equal"] = comparison.bits_equal;
  if (flip) report["flip"] = to_json(*flip);
  report["overall"] = to_json(comparison.overall);
  for (const ChannelError& error : comparison.channels) report["channels"].push_back(to_json(error));
  print_report(common, report, to_text(comparison, (flip ? to_text(*flip) : "") + verdict));
  return pass ? exit_ok : exit_different;
}

void parse_metric(const std::string& text, DiffOptions& options) {
  const auto metric = find_metric(text);
  options.flip = text == "flip";
  if (!metric && !options.flip) {
    throw UsageError(fmt::format("--metric: '{}' is not one of {} flip", text, fmt::join(metric_names, " ")));
  }
  options.metric = metric.value_or(Metric::mse);
}

FlipMode parse_flip_mode(const std::string& text) {
  if (const auto mode = find_flip_mode(text)) return *mode;
  throw UsageError(fmt::format("--flip-mode: '{}' is not one of {}", text, fmt::join(flip_mode_names, " ")));
}

}  // namespace

void add_diff_command(CLI::App& app, CommonOptions& common, Action& action) {
  const auto options = std::make_shared<DiffOptions>();
  CLI::App* sub = add_subcommand(
      app, "diff",
      "Compare picture A with reference B, channel by channel. Without --max any difference is exit code 1.\n"
      "NaN equals NaN; a sample that is finite in one picture only makes the error infinite. Ids count 0 or 1.",
      examples, common);
  sub->add_option("A", options->picture, "The picture")->required();
  sub->add_option("B", options->reference, "The reference r: relmse is the mean of (x-r)^2 / (r^2 + 0.01)")->required();
  sub->add_option_function<std::string>(
         "--metric", [=](const std::string& text) { parse_metric(text, *options); },
         "What --max bounds: mse, relmse, psnr (dB, peak 1), mae, max or flip (mean visible difference, 0..1) [mse]")
      ->type_name("NAME");
  sub->add_option_function<std::string>(
         "--flip-mode", [=](const std::string& text) { options->flip_options.mode = parse_flip_mode(text); },
         "ldr or hdr [hdr for pictures of floats, ldr for 8-bit ones]")
      ->type_name("NAME");
  sub->add_option_function<std::string>(
         "--max",
         [=](const std::string& text) {
           options->bound = parse_real("--max", text, 0, std::numeric_limits<double>::max());
         },
         "Exit 1 when the overall metric is above V (psnr: below V)")
      ->type_name("V");
  sub->add_option("-o,--output", options->output,
                  "Write |A-B| of every channel (.exr), or a heat map of the largest (.png);\n"
                  "with --metric flip its error map")
      ->type_name("FILE");
  sub->callback([=, &common, &action] { action = [=, &common] { return run_diff(*options, common); }; });
}

}  // namespace rayloom::tools
