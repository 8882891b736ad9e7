#include <rayloom/tools/subcommand.h>

#include <CLI/CLI.hpp>

namespace rayloom::tools {

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& examples, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand(name, description);
  sub->footer(examples);
  sub->add_flag("-q,--quiet", common.quiet, "Print nothing on standard error but errors");
  sub->add_option("--json", common.json, "Print the results as JSON, or write them to a file with --json=FILE")
      ->type_name("[=FILE]");
  return sub;
}

}  // namespace rayloom::tools
