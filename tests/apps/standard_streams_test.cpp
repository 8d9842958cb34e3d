// Clouds from standard input and to standard output, and the example of each command's help.
#include <cstdlib>
#include <sstream>

#include "engine/io/ply_reader.hpp"
#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::standard_streams_test {

namespace {

Outcome inFolder(const ScratchFolder& folder, const std::string& command) {
  return run("cd " + folder.path().string() + " && PATH=" + std::filesystem::path(program()).parent_path().string() +
             ":$PATH && " + command);
}

}  // namespace

TEST_CASE("clouds named - pass through pipes in any format that is named, and words go to stderr") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "t");
  const auto pipes = [&](const std::string& command) { return inFolder(folder, "export TMPDIR=$PWD/t; " + command); };
  for (const std::string format : {"ply", "las", "xyz", "npz", "pcd"}) {
    CAPTURE(format);
    const Outcome info =
        pipes("palpate make sphere -n 1000 -o - --format " + format + " 2>words | palpate info - --format " + format);
    CHECK_MESSAGE(info.code == 0, info.text);
    CHECK(info.text.starts_with("standard input: 1000 points, "));
    CHECK(says(contentOf(folder / "words"), "1000 points of sphere"));
  }
  const Outcome sculpted = pipes(
      "palpate make sphere -n 3000 -o - --format=ply | palpate touch - --backend cpu --edit push --duration 0.3 --save "
      "- "
      "--format ply | palpate convert - out.las --format ply");
  CHECK_MESSAGE(sculpted.code == 0, sculpted.text);
  works("convert " + (folder / "out.las").string() + " " + (folder / "out.ply").string());
  CHECK(readPly(folder / "out.ply").size() >= 3000);
  CHECK(std::filesystem::is_empty(folder / "t"));
}

TEST_CASE("a cloud named - without a format, or beside --json -, is refused before any work") {
  const auto refuses = [](const std::string& command, const std::string& complaint) {
    const Outcome outcome = palpate(command + " < /dev/null");
    CHECK(outcome.code == 2);
    CHECK_MESSAGE(says(outcome.text, complaint), outcome.text);
  };
  refuses("info -", "model: - is standard input; name its format, as in --format ply");
  refuses("make sphere -o -", "--output: - is standard output; name its format, as in --format ply");
  refuses("make sphere -o - --format doc", "'doc' is not one of ply, las");
  refuses("make sphere -o - --format ply --json -", "--json: stdout is the cloud named -; name a file");
  CHECK(palpate("info - --format ply < /dev/null").text ==
        "palpate: standard input: is empty; it contains no points\n");
}

TEST_CASE("the help of each command ends in an example that works on any scan") {
  const ScratchFolder folder;
  works("make bumpy-sphere -n 4000 -o " + (folder / "scan.ply").string());
  std::size_t run = 0;
  const std::string commands = palpate("complete -- ''").text;
  std::istringstream names(commands);
  for (std::string name; std::getline(names, name) && !name.starts_with("/");) {
    if (isLeftOut(name)) continue;
    CAPTURE(name);
    std::string text = palpate(name + " --help").text;
    while (text.ends_with('\n')) text.pop_back();
    const std::string last = text.substr(text.rfind('\n') + 1), sign = "Example: palpate ";
    REQUIRE_MESSAGE(last.starts_with(sign), last);
    std::string example = last.substr(std::string("Example: ").size());
    const bool isEndless = name == "view" || name == "serve";  // until they are interrupted
    if (name == "view" && !std::getenv("DISPLAY")) continue;
    if (isEndless) example = "timeout -s INT 6 " + example;
    const Outcome outcome = inFolder(folder, example);
    CHECK_MESSAGE((isEndless ? outcome.code == 124 || outcome.code == 130 : outcome.code == 0), outcome.text);
    ++run;
  }
  CHECK(run >= 9);
}

}  // namespace palpate::standard_streams_test
