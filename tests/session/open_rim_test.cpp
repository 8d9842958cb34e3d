// A hand that slides off the open rim of a sheet under load, in sessions on the CPU.
#include <doctest/doctest.h>

#include "tests/session/session_scene.hpp"
#include "tests/touch/rim_scene.hpp"

namespace palpate::open_rim_test {

TEST_CASE("at an open rim the force on a loaded hand falls to zero no faster than it may rise") {
  const auto cpu = cpuBackend();
  for (const double depth : {1.0, 3.0, 4.0}) {
    CAPTURE(depth);
    const SessionConfig config{.model = {.file = "sheet"}, .backend = {.name = "cpu"}};
    const Model model{.cloud = openSheet(), .scale = {1}, .spacing = 1, .wideSpacing = 1};
    Session session(config, model, {.backend = *cpu, .threads = 1});
    const ServoResult result = runAlone(
        session, Path({{0, {0.3, 0.2, 4}}, {0.1, {0.3, 0.2, -depth}}, {0.4, {30, 0.2, -depth}}, {0.45, {30, 0.2, 4}}}));
    double loaded_N = 0, largest_N = 0;
    const auto& rows = result.trace().rows;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      loaded_N = std::max(loaded_N, glm::length(rows[i].force_N));
      largest_N = std::max(largest_N, glm::distance(rows[i].force_N, rows[i - 1].force_N));
    }
    CHECK(loaded_N > 0.7 * depth);
    CHECK(largest_N <= 1e-3 * config.force.maxRise_N_per_s * (1 + 1e-6));
    CHECK(rows.back().force_N == DVec3(0));
  }
}

}  // namespace palpate::open_rim_test
