// A dam break compared with an independent program, PySPH, if it is installed.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/labels.hpp"
#include "tests/matter/matter_scenes.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate::pysph_oracle_test {

namespace {

struct Front {
  double time_s, place_m;
};

bool hasPysph() {
  if (std::system("/usr/bin/python3 -c 'import pysph' > /dev/null 2>&1") == 0) return true;
  MESSAGE("skipped: there is no PySPH on this machine (package python3-pysph)");
  return false;
}

std::vector<Front> frontsByPysph(double width_m, double duration_s) {
  const ScratchFolder folder;
  const auto said = folder.path() / "said.txt";
  const std::string command =
      fmt::format("/usr/bin/python3 '{}/tests/matter/pysph_dam.py' '{}' {} {} > '{}' 2>&1", sourceFolder().string(),
                  folder.path().string(), width_m, duration_s, said.string());
  const int status = std::system(command.c_str());
  std::vector<Front> fronts;
  std::string line, all;
  for (std::ifstream in(said); std::getline(in, line); all += line + "\n") {
    std::istringstream words(line);
    std::string word;
    Front front{};
    if (words >> word >> front.time_s >> front.place_m && word == "front") fronts.push_back(front);
  }
  REQUIRE_MESSAGE(status == 0, all);
  return fronts;
}

}  // namespace

TEST_CASE("the front of a dam break advances as with PySPH" * kFull) {
  if (!hasPysph()) return;
  const MatterScene scene = matterSceneNamed("dam");
  const double width_m = scene.fill_mm.x * 1e-3;
  REQUIRE(scene.fill_mm.y == 2 * scene.fill_mm.x);
  const std::vector<Front> expected = frontsByPysph(width_m, 0.22);
  REQUIRE(expected.size() > 100);
  CHECK(expected.back().place_m > 3.5 * width_m);
  MatterWorld world(scene, {.threads = 2});
  std::size_t next = 0;
  double worst = 0;
  for (int k = 1; k <= 210; ++k) {
    run(world, 1);
    while (next + 1 < expected.size() && expected[next].time_s < world.time_s()) ++next;
    if (k < 50 || k % 20 != 0) continue;
    worst = std::max(worst, std::abs(world.observe().front_m / expected[next].place_m - 1));
  }
  checkAtMost("front of a dam against PySPH from 60 to 200 ms, %", 100 * worst, 4);
}

}  // namespace palpate::pysph_oracle_test
