#include <rayloom/tools/cli.h>

#include <rayloom/base/error.h>
#include <rayloom/base/version.h>
#include <rayloom/tools/interrupt.h>
#include <rayloom/tools/version.h>

#include <cstdio>
#include <new>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

/// CLI11 prints examples (its footer) last; a reader wants them first.
class ExamplesFirst : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return app->get_description() + "\n\nExamples:\n" + app->get_footer() + "\n";
  }
  std::string make_footer(const CLI::App*) const override { return {}; }
};

constexpr const char* main_examples =
    "  rayloom render atrium -o atrium.exr --spp 64      a picture of a procedural scene\n"
    "  rayloom render house.glb -o house.png             a preview of a glTF file\n"
    "  rayloom simulate cornell -o out --spp 1           the same on a simulated GPU\n"
    "  rayloom diff a.exr b.exr --metric relmse --max 1e-3\n"
    "  rayloom scene house.glb --json                    what is in the file\n";

void build_application(CLI::App& app, CommonOptions& common, Action& action) {
  app.formatter(std::make_shared<ExamplesFirst>());
  app.footer(main_examples);
  app.require_subcommand(1);
  app.set_version_flag("--version", version_report, "Print version, compiler, instruction sets, commit, float flags");
  add_render_command(app, common, action);
  add_simulate_command(app, common, action);
  add_diff_command(app, common, action);
  add_bvh_command(app, common, action);
  add_scene_command(app, common, action);
  add_bench_command(app, common, action);
}

/// Runs `action`; the order of the handlers is the order of blame: the command line, the input, the machine, us.
int run_guarded(const Action& action, const CommonOptions& common) {
  try {
    return action();
  } catch (const UsageError& error) {
    fmt::print(stderr, "rayloom: {}\n", error.what());
    return exit_usage;
  } catch (const InputError& error) {
    fmt::print(stderr, "rayloom: {}\n", error.what());
    return exit_bad_input;
  } catch (const Interrupted&) {
    fmt::print(stderr, "rayloom: interrupted, nothing was written\n");
    return exit_interrupted;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr,
               "rayloom: out of memory: the scene, the picture or the simulation does not fit; "
               "try a smaller --size\n");
    return exit_bad_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rayloom: internal error: {}\nThis is a fault in rayloom {}. To see it again:\n  {}\n",
               error.what(), version_text(), common.command);
    return exit_internal;
  }
}

/// CLI11 would only say that a subcommand is missing.
void require_known_subcommand(const CLI::App& app, std::span<const std::string> arguments) {
  const std::vector<const CLI::App*> subs = app.get_subcommands({});
  if (subs.empty() || arguments.empty() || arguments.front().starts_with('-')) return;
  std::string names;
  for (const CLI::App* sub : subs) {
    if (sub->get_name() == arguments.front()) return require_known_subcommand(*sub, arguments.subspan(1));
    names += " " + sub->get_name();
  }
  throw UsageError(fmt::format("there is no subcommand '{}'; there are:{}", arguments.front(), names));
}

/// "rayloom", "rayloom diff", "rayloom bench build": as far as the command line was understood.
std::string chosen_command(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return app.get_name() + (chosen.empty() ? "" : " " + chosen_command(*chosen.front()));
}

}  // namespace

std::string shell_quote(const std::string& word) {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("-_./=,:+@%", c); };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> normalise_arguments(int argc, const char* const* argv) {
  std::vector<std::string> arguments;
  for (int i = 1; i < argc; ++i) arguments.emplace_back(std::string(argv[i]) == "--json" ? "--json=-" : argv[i]);
  return arguments;
}

int run_command_line(int argc, const char* const* argv) {
  CommonOptions common;
  for (int i = 0; i < argc; ++i) common.command += (i ? " " : "") + (i ? shell_quote(argv[i]) : std::string("rayloom"));
  Action action;
  CLI::App app("Rayloom: a software DXR ray tracing runtime with a simulated RT core.", "rayloom");
  const auto parse_and_run = [&] {
    build_application(app, common, action);
    std::vector<std::string> arguments = normalise_arguments(argc, argv);
    require_known_subcommand(app, arguments);
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    return action();
  };
  const auto explain_parsing = [&] {
    try {
      return parse_and_run();
    } catch (const CLI::Success& success) {
      app.exit(success);
      return static_cast<int>(exit_ok);
    } catch (const CLI::ParseError& error) {
      throw UsageError(fmt::format("{}\nSee '{} --help'.", error.what(), chosen_command(app)));
    }
  };
  set_up_signals();
  return run_guarded(explain_parsing, common);
}

}  // namespace rayloom::tools
