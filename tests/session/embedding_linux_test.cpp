// The ten-line program in the README.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "engine/io/ply_writer.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"
#include "tests/source_folder.hpp"

namespace palpate::embedding_test {

TEST_CASE("the embedding program feels a model's surface") {
  const ScratchFolder folder;
  writePly(folder / "sphere.ply", makeScene("sphere", 4'000).cloud);
  const std::string command = fmt::format("{} {}", PALPATE_EMBEDDING, (folder / "sphere.ply").string());
  std::FILE* const output = ::popen(command.c_str(), "r");
  REQUIRE(output);
  std::array<char, 64> line{};
  CHECK(std::fgets(line.data(), line.size(), output));
  CHECK(::pclose(output) == 0);
  const double peak_N = std::atof(line.data());
  CHECK(peak_N > 1);  // 2 mm deep at 0.8 N/mm
  CHECK(peak_N < 1.7);
  CHECK(std::string(line.data()).find("N at most") != std::string::npos);
}

TEST_CASE("the README shows the tested embedding program") {
  const std::filesystem::path top = sourceFolder();
  if (!std::filesystem::exists(top / "README.md")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  CHECK(contentOf(top / "README.md").find(contentOf(top / "tests/programs/embedding.cpp")) != std::string::npos);
}

}  // namespace palpate::embedding_test
