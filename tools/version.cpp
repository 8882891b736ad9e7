#include <rayloom/accel/trace.h>
#include <rayloom/base/version.h>
#include <rayloom/tools/version.h>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

std::string instruction_sets() {
  std::string list;
  for (const accel::Isa isa : {accel::Isa::scalar, accel::Isa::avx2, accel::Isa::avx512}) {
    if (!accel::isa_supported(isa)) continue;
    const char* mark = isa == accel::current_isa() ? " (in use)" : "";
    list += fmt::format("{}{}{}", list.empty() ? "" : ", ", accel::isa_name(isa), mark);
  }
  return list;
}

const char* or_else(const char* text, const char* otherwise) { return *text ? text : otherwise; }

}  // namespace

std::string version_report() {
  const Version& built = version();
  return fmt::format(
      "rayloom {}\ncommit: {}\ncompiler: {}\nbuild type: {}\nsanitizers: {}\nfloat flags: {}\ninstruction sets: {}",
      built.number, or_else(built.commit, "unknown"), built.compiler, built.build_type,
      or_else(built.sanitizers, "none"), RAYLOOM_FLOAT_FLAGS, instruction_sets());
}

}  // namespace rayloom::tools
