// The layer between hands and a simulation, tested with known answers: which steps it takes, the hands' positions in
// each, and the force from an old answer.
#include "engine/matter/matter_steps.hpp"

#include <doctest/doctest.h>

#include <atomic>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/matter/matter_touch.hpp"
#include "engine/matter/tool_body.hpp"
#include "tests/near.hpp"

namespace palpate::matter_steps_test {

namespace {

constexpr DVec3 kForce_N(0.3, 1.2, -0.4), kPlace_m(0.02, 0.03, 0.04), kVelocity_m_s(0.05, -0.2, 0.1),
    kTorque_Nm(0.002, 0, -0.003);

// Records of a simulation whose behaviour the test sets, and that behaviour.
struct Told {
  std::vector<HandPose> from, to;  // of the first hand, one for each step
  int begun = 0, placed = 0;
  std::vector<double> gains;  // new gains, in order
  MatterState state = MatterState::running;
  std::atomic<bool> waits = false;
  bool faulty = false;  // as after a lost GPU
};

// Reports the same for its tools at each step.
class ToldSimulation final : public MatterSimulation {
 public:
  ToldSimulation(const MatterScene& scene, Told& told)
      : MatterSimulation(scene, {.tools = 1}, {Vec3(0.01f)}), told_(told) {
    reset();
  }
  std::optional<double> gpuTime_us() const override { return std::nullopt; }
  std::vector<Vec3> positionsById() const override { return {Vec3(0.01f)}; }
  std::vector<Vec3> velocitiesById() const override { return {Vec3(0.5f, 0, 0)}; }
  void setVelocities(std::span<const Vec3>) override {}

 private:
  void begin() override { ++told_.begun; }
  void takeParameters() override { told_.gains.push_back(scene().gain); }
  void placeToolAt(std::size_t, const HandPose&) override { ++told_.placed; }
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override {
    told_.waits.wait(true);
    if (told_.faulty) throw Error("the GPU is lost");
    told_.from.push_back(from[0]);
    told_.to.push_back(to[0]);
    const DVec3 impulse = -kMatterStep_s / scene().gain * kForce_N;
    return {.state = told_.state,
            .tools = {{.springImpulse = impulse,
                       .impulse = -impulse,
                       .angular = kMatterStep_s / scene().gain * kTorque_Nm,
                       .place_m = kPlace_m,
                       .velocity_m_s = kVelocity_m_s}}};
  }
  std::vector<Vec4> pressedPlaces() const override { return {}; }

  Told& told_;
};

MatterScene smallScene() {
  MatterScene scene{.box_mm = DVec3(80), .fill_mm = DVec3(40), .spacing_mm = 10, .gain = 3};
  scene.tool = usualTool(scene);
  return scene;
}

MatterQuestion at(double time_s, const DVec3& place_m) {
  MatterQuestion question{.time_s = time_s};
  question.hands[0].place_m = place_m;
  return question;
}

MatterSteps stepsOf(Told& told, std::uint32_t mostAtOnce = 0) {
  return {std::make_unique<ToldSimulation>(smallScene(), told), 1, mostAtOnce};
}

// A simulation in real time that has answered one pose and answers no further ones.
struct Stale {
  Told told;
  MatterTouch touch{std::make_unique<ToldSimulation>(smallScene(), told), {.hands = 1, .realtime = true}};
  Pose asked{.time_s = 0.1, .hip = {10, 20, 30}};
  Contact first;

  explicit Stale(double gain = smallScene().gain) {
    touch.simulation()->set("gain", gain);
    first = touch.query(asked, 0);
    told.waits = true;
  }
  ~Stale() {
    told.waits = false;
    told.waits.notify_all();
  }
  Contact later(double age_s, const DVec3& way) {
    return touch.query({.time_s = asked.time_s + age_s, .hip = asked.hip + way}, 1);
  }
};

}  // namespace

TEST_CASE("a matter ball jumps with a hand that is put down elsewhere, instead of moving there") {
  Told told;
  MatterSteps steps = stepsOf(told);
  steps.goTo(at(0, {1, 0, 0}));
  CHECK(told.placed == 1);
  MatterQuestion next = at(0.003, {50, 8, 0});
  next.putDown[0] = 1;
  steps.goTo(next);
  CHECK(told.placed == 2);
  REQUIRE(told.to.size() == 4);
  for (std::size_t k = 1; k < 4; ++k) {
    CHECK(told.from[k].place_m == DVec3(50, 8, 0));
    CHECK(told.to[k].place_m == DVec3(50, 8, 0));
  }
  next.time_s = 0.005;
  next.hands[0].place_m.x = 52;
  steps.goTo(next);  // same number of put-downs as before
  CHECK(told.placed == 2);
  CHECK(told.to[4].place_m.x == near(51, 1e-6));
}

TEST_CASE("an answer from before the hand was put down elsewhere is not used") {
  Stale stale;
  CHECK(stale.later(0.001, DVec3(0)).force_N.has_value());
  stale.touch.resetHand(0);
  const Contact after = stale.later(0.001, DVec3(0));
  CHECK(after.valid);
  CHECK_FALSE(after.touching);
  CHECK_FALSE(after.force_N.has_value());
}

TEST_CASE("between two queries hands move in a straight line, step by step, and rotate evenly") {
  Told told;
  MatterSteps steps = stepsOf(told);
  steps.goTo(at(0, {1, 0, 0}));
  CHECK(told.to.size() == 1);  // the first question is one step
  MatterQuestion next = at(0.004, {5, 8, 0});
  next.hands[0].orientation = DQuat(std::cos(0.4), 0, std::sin(0.4), 0);
  steps.goTo(next);
  REQUIRE(told.to.size() == 5);
  for (int k = 1; k <= 4; ++k) {
    const HandPose& there = told.to[static_cast<std::size_t>(k)];
    CHECK(glm::distance(there.place_m, DVec3(1 + k, 2 * k, 0)) < 1e-12);
    CHECK(there.orientation.y == near(std::sin(0.1 * k), 1e-6));
    CHECK(glm::distance(told.from[static_cast<std::size_t>(k)].place_m,
                        told.to[static_cast<std::size_t>(k - 1)].place_m) < 1e-12);
  }
  steps.goTo(at(0.0041, {9, 9, 9}));  // less than a step later
  CHECK(told.to.size() == 5);
  steps.goTo(at(0.005, {5, 8, 4}));
  REQUIRE(told.to.size() == 6);
  CHECK(told.to.back().place_m == DVec3(5, 8, 4));
}

TEST_CASE("the simulation restarts with a single step when time goes back or on request") {
  Told told;
  MatterSteps steps = stepsOf(told);
  CHECK(told.begun == 1);
  for (int k = 0; k < 10; ++k) steps.goTo(at(1e-3 * k, {0, 0, 1e-3 * k}));
  CHECK(told.to.size() == 10);
  steps.goTo(at(0.009, {0, 0, 1}));  // the same time is not a step back
  CHECK(told.begun == 1);
  steps.goTo(at(0.004, {0, 0, 7}));
  CHECK(told.begun == 2);
  CHECK(told.to.size() == 11);
  CHECK(told.from.back().place_m == told.to.back().place_m);  // the hand did not move from its previous position
  steps.goTo(at(0.005, {0, 0, 8}));
  CHECK(told.to.size() == 12);
  CHECK(steps.world().time_s() == near(0.002, 1e-6));
  steps.reset();
  steps.goTo(at(0.105, {0, 0, 9}));
  CHECK(told.begun == 3);
  CHECK(told.to.size() == 13);
  CHECK(told.from.back().place_m == DVec3(0, 0, 9));
}

TEST_CASE("a paused simulation takes no step and gives no force, and resumes at the present hand") {
  Told told;
  MatterSteps steps = stepsOf(told);
  CHECK(steps.goTo(at(0, {1, 0, 0})).moves);
  steps.pause(true);
  const MatterAnswer held = steps.goTo(at(0.01, {2, 0, 0}));
  CHECK_FALSE(held.moves);
  CHECK(told.to.size() == 1);
  steps.goTo(at(0.02, {3, 0, 0}));
  steps.pause(false);
  CHECK(steps.goTo(at(0.022, {5, 0, 0})).moves);
  REQUIRE(told.to.size() == 3);
  CHECK(told.to[1].place_m.x == near(4, 1e-6));
  CHECK(told.to[2].place_m.x == near(5, 1e-6));
}

TEST_CASE("steps beyond the maximum per query are dropped and counted, and the last one reaches the hand's position") {
  Told told;
  MatterSteps steps = stepsOf(told, 2);
  steps.goTo(at(0, {0, 0, 0}));
  steps.goTo(at(0.002, {2, 0, 0}));
  CHECK(steps.dropped_s() == 0);
  steps.goTo(at(0.012, {8, 0, 0}));
  CHECK(steps.dropped_s() == near(0.008, 1e-6));
  REQUIRE(told.to.size() == 5);
  CHECK(told.to[3].place_m.x == near(5, 1e-6));
  CHECK(told.to[4].place_m.x == near(8, 1e-6));
}

TEST_CASE("a displayed frame belongs to the time of its query, is returned once, and is the newest") {
  Told told;
  MatterSteps steps = stepsOf(told);
  MatterView view;
  CHECK_FALSE(steps.take(view));
  steps.goTo(at(0.25, {}));
  REQUIRE(steps.take(view));
  CHECK(view.time_s == 0.25);
  CHECK(view.positions == steps.world().positionsById());
  CHECK(view.velocities == steps.world().velocitiesById());
  CHECK_FALSE(steps.take(view));
  steps.goTo(at(0.253, {}));
  REQUIRE(steps.take(view));
  CHECK(view.time_s == 0.253);
}

TEST_CASE("an answer of the same tick is felt unchanged") {
  Stale stale;
  CHECK(stale.first.fresh);
  CHECK(stale.first.dataTime_s == 0.1);
  REQUIRE(stale.first.force_N);
  CHECK(glm::distance(*stale.first.force_N, kForce_N) < 1e-12);
  CHECK(glm::distance(stale.first.torque_mNm, 1e3 * kTorque_Nm) < 1e-12);
  CHECK(glm::distance(stale.first.proxy, 1e3 * kPlace_m) < 1e-9);
  CHECK(glm::distance(stale.first.velocity, 1e3 * kVelocity_m_s) < 1e-9);
  CHECK(glm::distance(stale.first.normal, glm::normalize(kForce_N)) < 1e-12);
}

TEST_CASE("an old answer is extended by the spring to the ball when the hand has moved on") {
  Stale stale;
  const MatterScene scene = smallScene();
  const double stiffness_N_mm = 1e-3 * scene.gain * toolSpring(scene.tool, kMatterStep_s).stiffness;
  const DVec3 way(0.7, -1.1, 0.2);
  const double age_s = 0.004;
  const Contact later = stale.later(age_s, way);
  CHECK_FALSE(later.fresh);
  CHECK(later.valid);
  CHECK(later.dataTime_s == 0.1);
  REQUIRE(later.force_N);
  // The ball continues at its velocity, and moving the hand along does not stretch the spring.
  const DVec3 went = 1e3 * age_s * kVelocity_m_s;
  CHECK(glm::distance(*later.force_N, kForce_N - stiffness_N_mm * (way - went)) < 1e-9);
  CHECK(glm::distance(later.proxy, 1e3 * kPlace_m + went) < 1e-9);
  CHECK(glm::distance(later.velocity, 1e3 * kVelocity_m_s) < 1e-9);
  CHECK(glm::distance(later.normal, glm::normalize(*later.force_N)) < 1e-12);
  const Contact along = stale.later(age_s, went);
  CHECK(glm::distance(*along.force_N, kForce_N) < 1e-9);
  // The force fades to zero.
  const double older_s = 0.0125;
  const Contact half = stale.later(older_s, 1e3 * older_s * kVelocity_m_s);
  CHECK(glm::distance(*half.force_N, 0.5 * kForce_N) < 1e-9);
  CHECK(glm::distance(half.torque_mNm, 500.0 * kTorque_Nm) < 1e-9);
  const Contact none = stale.later(0.021, {});
  CHECK_FALSE(none.touching);
  CHECK_FALSE(none.force_N);
  CHECK(none.torque_mNm == DVec3(0));
  CHECK(none.valid);
}

TEST_CASE("an old answer is extended by the spring with the latest gain") {
  Stale stale(8);
  const double stiffness_N_mm = 1e-3 * 8 * toolSpring(smallScene().tool, kMatterStep_s).stiffness;
  const DVec3 way(0.7, -1.1, 0.2), went = 4.0 * kVelocity_m_s;
  const Contact later = stale.later(0.004, way);
  REQUIRE(later.force_N);
  CHECK(glm::distance(*later.force_N, kForce_N - stiffness_N_mm * (way - went)) < 1e-9);
}

TEST_CASE("a failed simulation gives no valid answer, and a paused one no force") {
  Told told;
  MatterTouch touch(std::make_unique<ToldSimulation>(smallScene(), told), {.hands = 1});
  CHECK(touch.query({.time_s = 0, .hip = DVec3(9)}, 0).touching);
  touch.simulation()->pause(true);
  const Contact held = touch.query({.time_s = 0.001, .hip = DVec3(9)}, 0);
  CHECK(held.valid);
  CHECK_FALSE(held.touching);
  touch.simulation()->pause(false);
  CHECK(touch.query({.time_s = 0.002, .hip = DVec3(9)}, 0).touching);
  told.state = MatterState::crowded;
  CHECK_FALSE(touch.query({.time_s = 0.003, .hip = DVec3(9)}, 0).valid);
  CHECK(touch.simulation()->failure() == "has too many particles in one place");
}

TEST_CASE("a parameter is applied once, with the next step, and a refused one changes nothing") {
  Told told;
  MatterSteps steps = stepsOf(told);
  steps.goTo(at(0, {1, 0, 0}));
  steps.set("gain", 7);
  steps.set("gain", 8);
  CHECK(told.gains.empty());
  CHECK(steps.parameters().back().value == 8);
  CHECK(steps.world().scene().gain == 3);
  CHECK_THROWS_WITH_AS(steps.set("gain", -1), "gain: is -1; it must be from 0 to 1000", Error);
  CHECK_THROWS_AS(steps.set("young_Pa", 1e4), Error);
  steps.goTo(at(0.001, {1, 0, 0}));
  steps.goTo(at(0.002, {1, 0, 0}));
  CHECK(told.gains == std::vector<double>{8});
  CHECK(steps.world().scene().gain == 8);
}

TEST_CASE("an exception of a simulation gives zero force and an invalid answer, and is reported on request") {
  for (const bool realtime : {false, true}) {
    CAPTURE(realtime);
    Told told;
    MatterTouch touch(std::make_unique<ToldSimulation>(smallScene(), told), {.hands = 1, .realtime = realtime});
    REQUIRE(touch.query({.time_s = 0.1, .hip = {10, 20, 30}}, 0).touching);
    told.faulty = true;
    for (const double time_s : {0.2, 0.3}) {
      const Contact contact = touch.query({.time_s = time_s, .hip = {10, 20, 30}}, 0);
      CHECK_FALSE(contact.valid);
      CHECK_FALSE(contact.touching);
      CHECK(contact.force_N.value_or(DVec3(0)) == DVec3(0));
    }
    told.faulty = false;
    CHECK_FALSE(touch.query({.time_s = 0.4, .hip = {10, 20, 30}}, 0).valid);
    CHECK_THROWS_WITH_AS(touch.finish(), "the GPU is lost", Error);
  }
}

}  // namespace palpate::matter_steps_test
