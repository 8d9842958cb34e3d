// A surface that rises under a hand: the force rises slowly, and where others raise it, is their work.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

#include "haptics/devices/simulated_touch.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/near.hpp"

namespace palpate::changed_surface_test {
namespace {

/// The plane z = 0, which rises in steps every tenth of a second from 1.5 s to 3 s.
class RisingPlane final : public OneHandQuery {
 public:
  explicit RisingPlane(double jump, bool isLate = false) : jump_(jump), isLate_(isLate) {}
  double heightAt(double time_s) const { return jump_ * std::floor(std::clamp(10 * (time_s - 1.5), 0.0, 15.0)); }

  Contact answerTo(const Pose& pose, double) noexcept override {
    const double height = heightAt(pose.time_s);
    const bool touching = pose.hip.z < height;
    // Sometimes old data let go of the hand: the proxy moves towards it.
    const double late = isLate_ ? std::clamp(std::fmod(pose.time_s, 0.2) - 0.182, 0.0, 0.018) / 0.02 : 0;
    return {.proxy = touching ? DVec3(pose.hip.x, pose.hip.y, glm::mix(height, pose.hip.z, late)) : pose.hip,
            .normal = {0, 0, 1},
            .touching = touching,
            .fresh = late == 0,
            .valid = true};
  }

 private:
  double jump_;
  bool isLate_;
};

/// News of that time are current, however long a test takes.
const InformationAge::Clock::time_point kAfterTest = InformationAge::Clock::now() + std::chrono::hours(1);

ServoResult pressed(double jump, const InformationAge* known, bool isLate = false, const ForceOptions& force = {},
                    PassivityMode passivity = PassivityMode::observe) {
  RisingPlane plane(jump, isLate);
  SimulatedTouch hand(Path({{0, {0, 0, 3}}, {0.5, {0, 0, 3}}, {1, {0, 0, -4}}, {4, {0, 0, -4}}}), {});
  return ServoLoop(hand, plane, ForceLaw(force, {}), {.duration_s = 4.5, .known = known}, {.passivity = passivity})
      .run();
}

/// Largest growth of the force in a tick beyond what the hand's own motion does to spring and damper.
double steepest_N(const ServoResult& result, double from_s) {
  const ForceOptions force;
  double most_N = 0;
  const auto& rows = result.trace().rows;
  for (std::size_t i = 2; i < rows.size(); ++i) {
    if (rows[i].time_s <= from_s) continue;
    const DVec3 way = rows[i].hip - rows[i - 1].hip, lastWay = rows[i - 1].hip - rows[i - 2].hip;
    const double hand_N =
        glm::length(force.stiffness_N_per_mm * way + force.damping_N_s_per_mm / 0.001 * (way - lastWay));
    most_N = std::max(most_N, glm::length(rows[i].force_N) - glm::length(rows[i - 1].force_N) - hand_N);
  }
  return most_N;
}

double fastest_mm_per_s(const ServoResult& result, double from_s) {
  double most_mm = 0;
  const auto& rows = result.trace().rows;
  for (std::size_t i = 20; i < rows.size(); ++i)
    if (rows[i].time_s > from_s) most_mm = std::max(most_mm, glm::distance(rows[i].hip, rows[i - 20].hip));
  return most_mm / 0.02;
}

}  // namespace

TEST_CASE("a raised surface lifts the hand slowly, and one raised by others does not count as energy from the loop") {
  InformationAge still(kAfterTest), changing(kAfterTest);
  changing.changed(kAfterTest);
  const ServoResult own = pressed(0.5, &still), others = pressed(0.5, &changing), rest = pressed(0, &changing);
  // The hand is lifted by the raised surface.
  CHECK(others.trace().rows.back().hip.z > rest.trace().rows.back().hip.z + 0.5);
  CHECK(*own.counts().leastEnergy_mJ < -1);
  CHECK(*others.counts().leastEnergy_mJ > -1);
  CHECK(steepest_N(own, 1.5) < 0.065);
  CHECK(steepest_N(others, 1.5) < 0.065);
  CHECK(own.trace().rows.back().hip == others.trace().rows.back().hip);
  CHECK(*rest.counts().leastEnergy_mJ > -1);
  CHECK(glm::length(rest.trace().rows.back().force_N) ==
        near(glm::length(pressed(0, &still).trace().rows.back().force_N), 1e-6));
}

TEST_CASE("a hand gets at most half a millijoule more than it put in, however others raise the surface") {
  InformationAge changing(kAfterTest);
  changing.changed(kAfterTest);
  for (const double jump : {0.02, 0.1, 0.3, 0.5, 1.0, 2.0})
    for (const bool isLate : {false, true}) {
      CAPTURE(jump);
      CAPTURE(isLate);
      const ServoResult freely = pressed(jump, &changing, isLate);
      const ServoResult limited = pressed(jump, &changing, isLate, {}, PassivityMode::on);
      CHECK(*limited.counts().leastEnergy_mJ > -Passivity::kLent_mJ);
      CHECK(steepest_N(limited, 1.5) < 0.065);
      // It is held nevertheless, and comes to rest within a few encoder steps.
      CHECK(glm::length(limited.trace().rows.back().force_N) > 0.5);
      CHECK(fastest_mm_per_s(limited, 4.2) < 15);
      if (isLate) {
        CHECK(*freely.counts().leastEnergy_mJ < -10);
      } else {
        CHECK(limited.trace().rows.back().hip.z == within(freely.trace().rows.back().hip.z, 0.2));
      }
    }
}

TEST_CASE("with occasional late answers a surface that others could change is felt as any other") {
  InformationAge still(kAfterTest), changing(kAfterTest);
  changing.changed(kAfterTest);
  const ServoResult own = pressed(0, &still, true), others = pressed(0, &changing, true);
  CHECK(own.trace().rows.back().hip == others.trace().rows.back().hip);
  CHECK(*others.counts().leastEnergy_mJ == near(*own.counts().leastEnergy_mJ, 1e-6));
}

}  // namespace palpate::changed_surface_test
