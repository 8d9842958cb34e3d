// Energy that a hand puts into water: counted from the forces that reached its device, not from withheld ones.
#include <doctest/doctest.h>

#include "haptics/simulation/matter_choice.hpp"
#include "tests/near.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::port_energy_test {

namespace {

/// Down into a small tank, and partly out again.
Path dive() {
  return Path(
      {{0, {40, 100, 40}}, {0.15, {40, 100, 40}}, {0.4, {40, 35, 40}}, {0.5, {45, 35, 40}}, {0.6, {45, 50, 40}}});
}

struct Dive {
  double said_mJ = 0;   ///< reported by the simulation
  double given_mJ = 0;  ///< from the trace: displacement times written force
  double most_N = 0;
};

Dive dived(double gain, double maxForce_N) {
  static const auto cpu = cpuBackend();
  SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
  MatterScene scene{.box_mm = {80, 120, 80}, .fill_mm = {80, 70, 80}, .spacing_mm = 10, .gain = gain};
  scene.tool = {.radius_mm = 20, .mass_kg = 0.034};
  config.model.matter = sceneRef(scene);
  config.force.maxForce_N = maxForce_N;
  Log log(true);
  const auto model = std::make_shared<const Model>(loadModel(config.model, {.log = log, .threads = 1}));
  Session session(config, model, {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, dive());
  Dive dive{.said_mJ = 1e3 * session.simulation()->portEnergies().front().now_J};
  const std::vector<TraceRow>& rows = result.trace().rows;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    dive.given_mJ -= glm::dot((rows[i - 1].force_N + rows[i].force_N) / 2.0, rows[i].hip - rows[i - 1].hip);
    dive.most_N = std::max(dive.most_N, glm::length(rows[i].force_N));
  }
  return dive;
}

}  // namespace

TEST_CASE("the energy of a hand in water is computed from the forces after all limits") {
  for (const auto& [gain, maxForce_N] : {std::pair{1.0, 20.0}, {40.0, 0.5}, {40.0, 3.0}}) {
    CAPTURE(gain);
    CAPTURE(maxForce_N);
    const Dive dive = dived(gain, maxForce_N);
    CAPTURE(dive.most_N);
    CHECK(dive.most_N > 0.4);
    CHECK(dive.given_mJ > 1);
    CHECK(dive.said_mJ == near(dive.given_mJ, 0.15));
  }
}

}  // namespace palpate::port_energy_test
