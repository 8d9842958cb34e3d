// Matter simulated without a hand, through the program.
#include <cmath>

#include "engine/core/processor.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::simulate_test {

namespace {

constexpr const char* kSmallTank =
    R"({"matter": "water", "box_mm": [80, 160, 80], "fill_mm": [80, 120, 80], "spacing_mm": 10})";

}  // namespace

TEST_CASE("a scene is simulated without a hand, and its particles are saved") {
  const ScratchFolder folder;
  const std::string scene = (folder / "tank.json").string(), json = (folder / "out.json").string();
  std::ofstream(scene) << kSmallTank;
  works("simulate " + scene + " --duration 0.4 --probe 40,60,40 --save " + (folder / "out.ply").string() + " --json " +
        json);
  const auto result = jsonOf(json);
  CHECK(result["particles"] == 8 * 12 * 8);
  CHECK(std::abs(result["time_s"].get<double>() - 0.4) < 1e-9);
  CHECK(std::abs(result["pressure_Pa"].get<double>() - 1000 * 9.81 * 0.06) < 60);
  CHECK(result["max_compression"] < 0.02);
  CHECK(result["potential_J"] > 0);
  CHECK(result["kinetic_J"] < 0.01);
  CHECK(result["momentum_kg_m_s"].size() == 3);
  CHECK(std::abs(result["front_mm"].get<double>() - 80) < 0.01);
  CHECK(result["step_us"]["p50"] > 0);
  CHECK(result["step_us"].contains("p999"));
  const PointCloud cloud = readPly(folder / "out.ply");
  CHECK(cloud.size() == 8 * 12 * 8);
  const Bounds bounds = boundsOf(cloud);
  CHECK(bounds.max.x > 70);
  CHECK(bounds.max.x < 80);
}

TEST_CASE("the built-in scenes run, with the same result for any number of threads") {
  const ScratchFolder folder;
  for (const std::string name : {"water", "dam", "sand", "jelly"}) {
    CAPTURE(name);
    const auto saved = [&](const std::string& threads) {
      const std::string file = (folder / (name + threads + ".ply")).string();
      works("simulate " + name + " --duration 0.02 --threads " + threads + " --save " + file);
      return contentOf(file);
    };
    CHECK(saved("1") == saved("3"));
  }
}

TEST_CASE("simulate reports the gain of a scene's forces and the coupling of the hand's ball") {
  const ScratchFolder folder;
  const std::string json = (folder / "out.json").string();
  checkEnds(0, "simulate drop --duration 0.001 --backend cpu --json " + json,
            {"100 times the simulated one; spring between hand and ball 0.426 N/mm"});
  CHECK(jsonOf(json)["gain"] == 100);
  CHECK(jsonOf(json)["coupling_N_mm"].get<double>() == near(0.426, 0.01));
  works("simulate jelly --duration 0.001 --backend cpu --json " + json);
  CHECK(jsonOf(json)["gain"] == 1);
  CHECK(jsonOf(json)["coupling_N_mm"].is_null());
}

TEST_CASE("a GPU simulates a scene like the CPU") {
  const ScratchFolder folder;
  const std::string scene = (folder / "tank.json").string(), json = (folder / "out.json").string();
  std::ofstream(scene) << kSmallTank;
  const auto moved = [&](const std::string& backend) {
    works("simulate " + scene + " --duration 0.05 --probe 40,60,40 --backend " + backend + " --json " + json);
    return jsonOf(json);
  };
  const auto gpu = moved("vulkan"), cpu = moved("cpu");
  CHECK(gpu["backend"] == "vulkan");
  CHECK(cpu["backend"] == "cpu");
  for (const char* value : {"pressure_Pa", "potential_J", "max_compression", "front_mm"}) {
    CAPTURE(value);
    CHECK(gpu[value].get<double>() == near(cpu[value].get<double>(), 0.01));
  }
  CHECK(palpate("simulate water --backend abacus").code == 2);
}

TEST_CASE("a closed scan is soft: its points fall and bend, and keep their order") {
  const ScratchFolder folder;
  const std::string scene = (folder / "soft.json").string(), json = (folder / "out.json").string();
  works("make sphere -n 5000 -o " + (folder / "ball.ply").string());
  std::ofstream(scene) << R"({"matter": "soft", "model": "ball.ply", "box_mm": [100, 100, 100], "fill_mm": [60, 60, 60],
                              "spacing_mm": 6, "young_Pa": 2e4, "poisson": 0.4})";
  works("simulate " + scene + " --duration 0.1 --save " + (folder / "out.ply").string() + " --json " + json);
  const auto result = jsonOf(json);
  CHECK(result["particles"] > 500);
  CHECK(result["pressure_Pa"].is_null());
  CHECK(result["max_compression"] > 0);
  CHECK(result["max_compression"] < 0.3);
  const PointCloud before = readPly(folder / "ball.ply"), after = readPly(folder / "out.ply");
  REQUIRE(after.size() == before.size());
  CHECK(after.hasNormals());
  const double scale = 60 / boundsOf(before).longestSide();
  double most = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    most =
        std::max(most, glm::length(DVec3(after.positions[i]) - scale * DVec3(before.positions[i]) - DVec3(50, 30, 50)));
  CHECK(most > 0.1);
  CHECK(most < 10);
  // On a GPU the particles are at the same positions as on the CPU.
  const auto there = [&](const std::string& backend) {
    const std::string file = (folder / (backend + ".ply")).string();
    works("simulate " + scene + " --duration 0.005 --backend " + backend + " --save " + file + " --json " + json);
    CHECK(jsonOf(json)["backend"] == backend);
    return readPly(file);
  };
  const PointCloud onGpu = there("vulkan"), onCpu = there("cpu");
  REQUIRE(onGpu.size() == onCpu.size());
  for (std::size_t i = 0; i < onGpu.size(); ++i) {
    REQUIRE(glm::length(onGpu.positions[i] - onCpu.positions[i]) < 1e-3f);
    REQUIRE(glm::length(onGpu.normals[i] - onCpu.normals[i]) < 1e-3f);
  }
  // The same scan is fixed in water, and keeps the water out.
  works("simulate water --model " + (folder / "ball.ply").string() + " --duration 0.005 --backend cpu --json " + json);
  const auto inWater = jsonOf(json)["model"];
  CHECK(inWater["volume_cm3"] > 10);
  CHECK(inWater["left_out"] > 10);
  CHECK(inWater["inside"] == 0);
  works("make plane -n 5000 -o " + (folder / "plane.ply").string());
  CHECK(says(palpate("simulate jelly --model " + (folder / "plane.ply").string()).text, "model: "));
}

TEST_CASE("a scene too large for the memory is refused before it runs, and info still describes it") {
  // Half of the machine's memory is allowed, at 1600 bytes a particle; this scene has more.
  const double particles = 1.2 * 0.5 * static_cast<double>(hostMemory_bytes()) / 1600;
  if (particles > 8e7) {
    MESSAGE("skipped: this machine has memory for more particles than a scene may have");
    return;
  }
  const ScratchFolder folder;
  const std::string scene = (folder / "sea.json").string(), json = (folder / "out.json").string();
  std::ofstream(scene) << fmt::format(
      R"({{"matter": "water", "box_mm": [1000, 1100, 1000], "fill_mm": [1000, 1000, 1000],
                                          "spacing_mm": {}}})",
      1000 / std::cbrt(particles));
  works("info " + scene + " --json " + json);
  CHECK(jsonOf(json)["particles"].get<double>() == near(particles, 0.02));
  for (const std::string command : {"simulate ", "touch --path builtin:press "})
    for (const std::string backend : {"cpu", "vulkan"}) {
      CAPTURE(command);
      CAPTURE(backend);
      const Outcome outcome = palpate(command + scene + " --backend " + backend);
      CHECK(outcome.code != 0);
      CHECK_MESSAGE(outcome.text.find("MiB of") != std::string::npos, outcome.text);
    }
}

TEST_CASE("an interrupted simulation keeps its results, and says how far it came") {
  const ScratchFolder folder;
  const std::filesystem::path said = folder / "said", json = folder / "out.json", save = folder / "out.ply";
  std::ofstream(folder / "scene.json") << kSmallTank;
  RunningProgram program("simulate " + (folder / "scene.json").string() + " --backend cpu --duration 100000 --json " +
                             json.string() + " --save " + save.string(),
                         said);
  CHECK(program.waitFor([&] { return contentOf(said).find(" 0 %") != std::string::npos; }));
  CHECK(WEXITSTATUS(program.wait(SIGTERM)) == 128 + SIGTERM);
  CHECK(says(contentOf(said), " of 100000 simulated seconds; the results until then are kept"));
  const Result result = jsonOf(json);
  CHECK(result["time_s"] > 0);
  CHECK(result["time_s"] < 100000);
  CHECK(std::filesystem::file_size(save) > 100);
}

TEST_CASE("a scene that cannot be simulated is refused with a reason, and leaves no file") {
  const ScratchFolder folder;
  const std::string scene = (folder / "scene.json").string(), save = (folder / "out.ply").string();
  const auto refusal = [&](const std::string& text) {
    std::ofstream(scene) << text;
    const Outcome outcome = palpate("simulate " + scene + " --save " + save);
    CHECK(outcome.code == 1);
    CHECK_FALSE(std::filesystem::exists(save));
    return outcome.text;
  };
  CHECK(says(refusal(R"({"matter": "soft"})"), "scene.json: "));
  CHECK(says(refusal(std::string(kSmallTank).replace(12, 5, "honey")), "choose water, sand, soft"));
  CHECK(says(refusal(std::string(kSmallTank).insert(1, "\"colour\": 1, ")), "colour: unknown key 'colour'"));
  CHECK(says(palpate("simulate nothing.json").text, "nothing.json"));
  CHECK(palpate("simulate water --duration -1").code == 2);
  CHECK(palpate("simulate water --probe 1,2").code == 2);
}

}  // namespace palpate::simulate_test
