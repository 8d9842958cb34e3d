// Files of every format that were cut in the middle, as by a full disk or a broken transfer.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "engine/io/e57_scans.hpp"
#include "tests/error_of.hpp"
#include "tests/io/fuzz_specimens.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::test::cut_files_test {

namespace {

bool has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

struct Heard final : LogListener {
  void said(std::string_view line) override { text += std::string(line) + "\n"; }
  void progressed(std::string_view, double) override {}
  std::string text;
};

/// What is said of half of a file: the error, or what the log got.
std::string saidOfHalf(const Specimen& specimen, bool& isRefused) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / specimen.name;
  const std::string whole = specimen.dressed ? specimen.dressed(specimen.text) : specimen.text;
  std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() / 2);
  Heard heard;
  Log log(true);
  log.listen(&heard);
  const std::string error = errorOf([&] { readCloud(file, &log, {.samples = 40}); });
  isRefused = !error.empty();
  if (isRefused) CHECK(error.starts_with(file.string()));
  return isRefused ? error : heard.text;
}

}  // namespace

TEST_CASE("half a file of any format is refused because it ends early, or is said to be possibly truncated") {
  std::set<std::string> tried;
  for (const Specimen& specimen : specimens()) {
    // Half of these .splat and .ptx files is as well a whole one.
    if (!specimen.beside.empty() || has("splat ptx", specimen.format)) continue;
    if (specimen.format == "e57" && !canReadE57()) continue;
    CAPTURE(specimen.name);
    CAPTURE(specimen.text.size());
    bool isRefused = false;
    const std::string said = saidOfHalf(specimen, isRefused);
    CHECK_MESSAGE((has(said, "ends") || has(said, "truncated")), said);
    const bool states = !has("xyz csv obj", specimen.format);  // how much it contains
    if (states) CHECK(isRefused);
    tried.insert(specimen.format);
  }
  CHECK(tried.size() >= 14);
}

TEST_CASE("half a file of points of equal size is said to end after so many of its points") {
  const ScratchFolder folder;
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.positions.emplace_back(i, i % 7, 0);
  for (const char* name : {"a.ply", "a.las", "a.pcd", "a.npy", "a.pts"}) {
    CAPTURE(name);
    const std::filesystem::path file = folder / name;
    writeCloud(file, cloud);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    const std::string error = errorOf([&] { readCloud(file); });
    const std::size_t at = error.find("ends after ");
    REQUIRE_MESSAGE(at != std::string::npos, error);
    CHECK(std::stoi(error.substr(at + 11)) == within(500, 40));
    CHECK(says(error, "of 1000 "));
    if (std::string_view(name) != "a.pts")
      CHECK(says(error, fmt::format(": byte {}: ", std::filesystem::file_size(file))));
  }
}

}  // namespace palpate::test::cut_files_test
