// The program without PALPATE_SIMULATION: one sentence says which option is missing.
#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::no_simulation_test {

TEST_CASE("a program built without PALPATE_SIMULATION refuses scenes, by file and by name, and says so") {
  const ScratchFolder folder;
  const std::string scene = (folder / "tank.json").string(), picture = (folder / "p.png").string();
  std::ofstream(scene) << R"({"matter": "water", "box_mm": [80, 120, 80], "fill_mm": [80, 70, 80], "spacing_mm": 10})";
  for (const std::string& command :
       {"touch " + scene, "info " + scene, "serve " + scene + " --name a", "render " + scene + " -o " + picture,
        "view " + scene, std::string("touch water"), std::string("info \"soft statue\""), std::string("simulate dam"),
        "simulate " + scene + " --duration 1"}) {
    const Outcome outcome = palpate(command);
    CAPTURE(command);
    CAPTURE(outcome.text);
    CHECK(outcome.code == 2);
    CHECK(says(outcome.text,
               "needs PALPATE_SIMULATION, which this palpate was built without; build it again with "
               "-DPALPATE_SIMULATION=ON"));
    CHECK(std::ranges::count(outcome.text, '\n') == 1);
  }
  const Outcome missing = palpate("info nothing.ply");
  CHECK_FALSE(says(missing.text, "PALPATE_SIMULATION"));
}

}  // namespace palpate::no_simulation_test
