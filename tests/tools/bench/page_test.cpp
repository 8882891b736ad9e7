// A page's files: CSV, SVG and one HTML that needs no other file.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/page.h>
#include <rayloom/tools/bench/process.h>

#include <cstdlib>
#include <filesystem>

#include <catch2/catch.hpp>

using namespace rayloom::bench;

namespace {

Page example() {
  Page page("speed", "Speed & cost");
  page.add_text("On one core <of two>.");
  page.add_table({"rates", "Rates", {{"set", "Mrays/s"}, {"a,b", "1.5"}}});
  page.add_chart({"graph", "A graph", {"x", false}, {"y", false}, {{"s", {{0, 1, 0, 0, ""}, {1, 2, 0, 0, ""}}}}});
  return page;
}

}  // namespace

TEST_CASE("A page writes its tables, charts and itself") {
  const TemporaryDirectory scratch;
  const std::string folder = scratch.file("deep/out");
  const std::vector<std::string> files = example().write(folder);
  CHECK(files == std::vector<std::string>{folder + "/rates.csv", folder + "/graph.csv", folder + "/graph.svg",
                                          folder + "/speed.html"});
  CHECK(read_whole_file(folder + "/rates.csv") == "set,Mrays/s\n\"a,b\",1.5\n");
  const std::string html = read_whole_file(folder + "/speed.html");
  for (const char* text : {"<h1>Speed &amp; cost</h1>", "<p>On one core &lt;of two&gt;.</p>", "<td>1.5</td>", "<svg"}) {
    CHECK_THAT(html, Catch::Contains(text));
  }
  CHECK_THAT(html, !Catch::Contains("<?xml") && !Catch::Contains("src="));
}

TEST_CASE("Without gnuplot the CSV files are there all the same") {
  const TemporaryDirectory scratch;
  const std::string path = std::getenv("PATH"), folder = scratch.file("out");
  setenv("PATH", "/nonexistent", 1);
  CHECK_THROWS_WITH(example().write(folder), Catch::Contains("gnuplot-nox"));
  setenv("PATH", path.c_str(), 1);
  CHECK(std::filesystem::exists(folder + "/graph.csv"));
  CHECK(std::filesystem::exists(folder + "/rates.csv"));
  CHECK_FALSE(std::filesystem::exists(folder + "/speed.html"));
}

TEST_CASE("A directory that cannot be made is an input error that names it") {
  const TemporaryDirectory scratch;
  CHECK_THROWS_WITH(example().write("/proc/no/such"), Catch::Contains("/proc/no/such"));
}

TEST_CASE("A program's streams and exit code come back; a missing one is named with its package") {
  const ProcessResult result = run_process("sh", {"-c", "cat; echo complaint >&2; exit 3"}, "said\n", "dash");
  CHECK(result.out == "said\n");
  CHECK(result.err == "complaint\n");
  CHECK(result.exit_code == 3);
  CHECK_THROWS_WITH(run_process("no-such-program", {}, "", "that-package"),
                    Catch::Contains("no-such-program") && Catch::Contains("that-package"));
}
