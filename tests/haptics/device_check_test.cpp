// The guided test of a device, with a simulated Touch in a hand that does what it is asked to.
#include "haptics/device_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "engine/core/error.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/devices/wrapped_device.hpp"
#include "tests/near.hpp"

namespace palpate::device_check_test {
namespace {

constexpr double kPeriod_s = 1e-3;

/// The hand goes where each stage asks it to, at a given speed, and leans 3 mm into the wall.
class ObedientHand {
 public:
  explicit ObedientHand(double speed_mm_per_s = 40) : speed_mm_per_s_(speed_mm_per_s) {}
  void follow(const DeviceCheckQuery& query) { query_ = &query; }

  DVec3 at(double time_s) {
    const DVec3 way_mm = goal() - place_mm_;
    const double distance_mm = glm::length(way_mm), reach_mm = speed_mm_per_s_ * std::max(0.0, time_s - time_s_);
    place_mm_ = distance_mm <= reach_mm ? goal() : place_mm_ + way_mm * (reach_mm / distance_mm);
    time_s_ = time_s;
    return place_mm_;
  }

  double depth_mm = 3;

 private:
  DVec3 goal() {
    const DeviceCheckStage stage = query_ ? query_->stage() : DeviceCheckStage::freeSpace;
    if (stage != stage_) from_mm_ = place_mm_;
    if (stage == DeviceCheckStage::lean && stage_ != stage) wall_mm_ = place_mm_ - DVec3(0, 5, 0);
    stage_ = stage;
    switch (stage) {
      case DeviceCheckStage::right:
        return from_mm_ + DVec3(30, 0, 0);
      case DeviceCheckStage::up:
        return from_mm_ + DVec3(0, 30, 0);
      case DeviceCheckStage::towards:
        return from_mm_ + DVec3(0, 0, 30);
      case DeviceCheckStage::lean:
      case DeviceCheckStage::leanAgain:
        return wall_mm_ - DVec3(0, depth_mm, 0);
      case DeviceCheckStage::lift:
        return wall_mm_ + DVec3(0, 8, 0);
      default:
        return from_mm_;
    }
  }

  double speed_mm_per_s_;
  const DeviceCheckQuery* query_ = nullptr;
  DeviceCheckStage stage_ = DeviceCheckStage::freeSpace;
  DVec3 place_mm_{0, -0.5, 0}, from_mm_{0}, wall_mm_{0};
  double time_s_ = 0;
};

/// Remembers what was written, and can fail or turn its axes.
class WatchedDevice final : public WrappedDevice {
 public:
  using WrappedDevice::WrappedDevice;
  DeviceState read(double time_s) noexcept override {
    DeviceState state = WrappedDevice::read(time_s);
    const DVec3 p = state.position;
    if (turned) state.position = {-p.z, p.y, p.x};
    if (clutch) state.buttons = kClutchButton;
    if (lies) state.position = {p.x, p.z, -p.y};
    if (fails && *fails <= time_s) state.ok = false;
    if (lost && lost->first <= time_s && time_s < lost->second) state.rendersForce = false;
    times_s.push_back(time_s);
    return state;
  }
  bool write(const DVec3& force_N) noexcept override {
    forces_N.push_back(glm::length(force_N));
    return WrappedDevice::write(lies ? DVec3(force_N.x, -force_N.z, force_N.y) : force_N);
  }
  std::string faultText() const override { return "the cable is unplugged"; }

  bool turned = false;
  bool clutch = false;  ///< the hand presses that button all the time
  bool lies = false;    ///< on its back: its -z is up
  std::optional<double> fails;
  std::optional<std::pair<double, double>> lost;
  std::vector<double> times_s, forces_N;
};

struct Rig {
  explicit Rig(const SimulatedTouchOptions& touch, double speed_mm_per_s = 40, DeviceCheckOptions options = {})
      : hand(speed_mm_per_s),
        device(std::make_unique<SimulatedTouch>([this](double time_s) { return hand.at(time_s); }, WorkspaceMap{},
                                                touch)) {
    options.realtime = false;
    query.emplace(options, device.limits());
    hand.follow(*query);
  }
  DeviceCheckResult run() { return checkDevice(device, *query); }

  ObedientHand hand;
  WatchedDevice device;
  std::optional<DeviceCheckQuery> query;
};

SimulatedTouchOptions touchWith(double damping_N_s_per_mm, double friction_N = 0) {
  SimulatedTouchOptions touch;
  touch.handDamping_N_s_per_mm = damping_N_s_per_mm - touch.viscosity_N_s_per_mm;
  touch.friction_N = friction_N;
  touch.workspace_mm = DVec3(160);
  return touch;
}

/// Whether mass, damper and the hand's spring are stable against a sampled spring whose force acts one tick late and is
/// held for a tick: the spectral radius of the exact discretization, x(k+1) = Phi x(k) - Gamma K x(k-1). SI units.
bool isStable(const SimulatedTouchOptions& touch, double stiffness_N_per_mm) {
  using Complex = std::complex<double>;
  const double m = touch.mass_kg, b = 1000 * (touch.handDamping_N_s_per_mm + touch.viscosity_N_s_per_mm),
               k = 1000 * touch.handStiffness_N_per_mm, wall = 1000 * stiffness_N_per_mm;
  const Complex root = std::sqrt(Complex(b * b - 4 * m * k));
  const Complex s1 = (-b + root) / (2 * m), s2 = (-b - root) / (2 * m);
  const Complex e1 = std::exp(s1 * kPeriod_s), e2 = std::exp(s2 * kPeriod_s);
  // Phi of the states position and velocity, and Gamma = integral of Phi times (0, 1/m).
  const double p11 = ((s1 * e2 - s2 * e1) / (s1 - s2)).real(), p12 = ((e1 - e2) / (s1 - s2)).real(),
               p21 = (s1 * s2 * (e2 - e1) / (s1 - s2)).real(), p22 = ((s1 * e1 - s2 * e2) / (s1 - s2)).real();
  const double g1 = (1 - p11) / k, g2 = p12 / m;
  // Characteristic polynomial with the delayed position as third state; power iteration would not see complex pairs.
  std::array<double, 9> a{p11, p12, -g1 * wall, p21, p22, -g2 * wall, 1, 0, 0};
  // Norm of A^(2^n), rescaled: its growth is the spectral radius.
  double logarithm = 0;
  constexpr int kDoublings = 40;
  for (int n = 0; n < kDoublings; ++n) {
    std::array<double, 9> squared{};
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t l = 0; l < 3; ++l) squared[3 * i + j] += a[3 * i + l] * a[3 * l + j];
    for (const double each : squared) most = std::max(most, std::abs(each));
    for (double& each : squared) each /= most;
    logarithm = 2 * logarithm + std::log(most);
    a = squared;
  }
  return logarithm < 0;
}

double exactLimit_N_per_mm(const SimulatedTouchOptions& touch) {
  double low = 1e-3, high = 100;
  REQUIRE(isStable(touch, low));
  REQUIRE_FALSE(isStable(touch, high));
  while (high > 1.0001 * low) (isStable(touch, std::sqrt(low * high)) ? low : high) = std::sqrt(low * high);
  return low;
}

}  // namespace

TEST_CASE("the device test finds the stiffness at which the contact becomes unstable, for any damping") {
  for (const double damping : {0.0015, 0.0025, 0.004}) {
    CAPTURE(damping);
    const SimulatedTouchOptions touch = touchWith(damping);
    Rig rig(touch);
    const DeviceCheckResult result = rig.run();
    const double exact = exactLimit_N_per_mm(touch);
    CAPTURE(exact);
    CHECK(result.oscillated);
    REQUIRE(result.stableStiffness_N_per_mm);
    const double share = *result.stableStiffness_N_per_mm / exact;
    CAPTURE(share);
    CHECK(share >= 0.6);
    CHECK(share <= 1.0);
    CHECK(*result.offeredStiffness_N_per_mm() < exact);
    CHECK(result.oscillation_s < 0.1);
    CHECK(result.peakForce_N <= kTouchPeakForce_N);
    CHECK(rig.device.forces_N.back() == 0);
    CHECK(result.freeForce_N == 0);
    CHECK(result.axesAreRight());
  }
}

TEST_CASE("the device test reports noise, gaps and turned axes in free space") {
  Rig rig(touchWith(0.0025, 0.26));
  rig.device.turned = true;
  const DeviceCheckResult result = rig.run();
  CHECK(result.axes == std::array{3, 2, -1});
  CHECK_FALSE(result.axesAreRight());
  REQUIRE(result.offeredAxes());
  CHECK(result.offeredAxes()->text() == "z,y,-x");
  CHECK(result.freeForce_N == 0);
  CHECK(result.noise_mm == 0);  // the hand is still, and held by friction
  CHECK(result.changedPoses == 0);
  CHECK(result.poses == within(3001, 1));
  CHECK(result.largestGap_s == near(kPeriod_s, 1e-6));
}

TEST_CASE("the wall of the device test lies below the hand, whatever the axes of the device") {
  Rig rig(touchWith(0.0025));
  rig.device.lies = true;
  const DeviceCheckResult result = rig.run();
  REQUIRE(result.offeredAxes());
  CHECK(result.offeredAxes()->text() == "x,-z,y");
  CHECK(result.oscillated);
  REQUIRE(result.stableStiffness_N_per_mm);
  Rig upright(touchWith(0.0025));
  CHECK(*result.stableStiffness_N_per_mm == near(*upright.run().stableStiffness_N_per_mm, 1e-9));
}

TEST_CASE("a hand that holds the clutch passes the device test all the same") {
  Rig rig(touchWith(0.0025), 40, {.stiffest_N_per_mm = 0.3});
  rig.device.clutch = true;
  const DeviceCheckResult result = rig.run();
  CHECK(result.axesAreRight());
  CHECK(result.stableStiffness_N_per_mm == 0.3);
}

TEST_CASE("directions that were not all seen, or seen twice, offer no axes") {
  DeviceCheckResult result{.axes = {1, 0, 3}};
  CHECK_FALSE(result.offeredAxes());
  result.axes = {1, 1, 3};
  CHECK_FALSE(result.offeredAxes());
  result.axes = {1, 2, 3};
  CHECK_FALSE(result.offeredAxes());
  result.axes = {-1, 2, 3};
  REQUIRE(result.offeredAxes());
  CHECK(result.offeredAxes()->mirrors());
  result.fault = "unplugged";
  CHECK_FALSE(result.offeredAxes());
}

TEST_CASE("a pause in the device test counts neither as leaning nor as an oscillation") {
  DeviceCheckQuery query({.freeSpace_s = 0.01, .softest_N_per_mm = 1}, {});
  double time_s = 0;
  DVec3 place_mm(0);
  DVec3 felt_N(0);
  const auto tick = [&](double dt_s) {
    time_s += dt_s;
    const Contact contact =
        query.answerTo({.time_s = time_s, .hip = place_mm, .felt = {.got_N = glm::length(felt_N)}}, 0);
    felt_N = contact.force_N.value_or(DVec3(0));
  };
  const auto go = [&](const DVec3& to_mm) {
    for (const DVec3 step_mm = (to_mm - place_mm) / 50.0; glm::distance(place_mm, to_mm) > 0.1; place_mm += step_mm)
      tick(1e-3);
  };
  for (int i = 0; i < 20; ++i) tick(1e-3);
  go({30, 0, 0});
  go({30, 30, 0});
  go({30, 30, 30});
  REQUIRE(query.stage() == DeviceCheckStage::lean);
  go({30, 23, 30});
  for (int i = 0; i < 100; ++i) tick(1e-3);
  REQUIRE(glm::length(felt_N) > 1);
  const double before_N_per_mm = query.stiffness_N_per_mm();
  tick(20);  // longer than a step, and with the next one than the patience for a stage
  tick(20);
  for (int i = 0; i < 100; ++i) tick(1e-3);
  CHECK(query.stage() == DeviceCheckStage::lean);
  CHECK(query.stiffness_N_per_mm() == before_N_per_mm);
  for (int i = 0; i < 800; ++i) tick(1e-3);
  CHECK(query.stiffness_N_per_mm() > before_N_per_mm);
}

TEST_CASE("the device test of a wall that stays stable ends at its stiffest step") {
  Rig rig(touchWith(0.0025), 40, {.stiffest_N_per_mm = 0.8});
  const DeviceCheckResult result = rig.run();
  CHECK_FALSE(result.oscillated);
  CHECK(result.stableStiffness_N_per_mm == 0.8);
  CHECK(*result.offeredStiffness_N_per_mm() == near(0.56, 1e-9));
}

TEST_CASE("the device test does not take a brisk tap on a stable wall for an oscillation") {
  Rig rig(touchWith(0.0025), 100, {.softest_N_per_mm = 0.7, .stiffest_N_per_mm = 0.8});
  const DeviceCheckResult result = rig.run();
  CHECK_FALSE(result.oscillated);
  CHECK(result.stableStiffness_N_per_mm == 0.8);
}

TEST_CASE("a device that fails in the middle of the test has no force within two ticks, and nothing is offered") {
  Rig rig(touchWith(0.0025));
  rig.device.fails = 12;  // leaning
  const DeviceCheckResult result = rig.run();
  CHECK(result.fault == "the cable is unplugged");
  CHECK(result.peakForce_N > 0.2);
  CHECK(result.stableStiffness_N_per_mm);
  CHECK_FALSE(result.offeredStiffness_N_per_mm());
  REQUIRE(rig.device.times_s.back() == near(12, 1e-3));  // the session ended there
  const auto& forces_N = rig.device.forces_N;
  const auto faulty = static_cast<std::ptrdiff_t>(rig.device.times_s.size()) - 1;  // the read that failed
  CHECK(forces_N[static_cast<std::size_t>(faulty) - 1] > 0.2);
  CHECK(std::all_of(forces_N.begin() + faulty, forces_N.end(), [](double each_N) { return each_N == 0; }));
  CHECK(std::ssize(forces_N) > faulty);
}

TEST_CASE("a device that gives no force for a while gets none from that tick on, and the force returns slowly") {
  Rig rig(touchWith(0.0025));
  rig.device.lost = {12, 12.05};
  rig.run();
  double before_N = 0, during_N = 0, after_N = 0;
  for (std::size_t i = 0; i < rig.device.times_s.size(); ++i) {
    const double t_s = rig.device.times_s[i], force_N = rig.device.forces_N[i];
    if (t_s > 11.9 && t_s < 11.999) before_N = std::max(before_N, force_N);
    if (t_s >= 12 && t_s < 12.049) during_N = std::max(during_N, force_N);
    if (t_s >= 12.05 && t_s < 12.06) after_N = std::max(after_N, force_N);
  }
  CHECK(before_N > 0.2);
  CHECK(during_N == 0);
  CHECK(after_N < 0.1 * before_N);
}

TEST_CASE("a person who does not lean, or who stops the test, is offered nothing") {
  {
    Rig rig(touchWith(0.0025), 40, {.stageTimeout_s = 5});
    rig.hand.depth_mm = -3;
    const DeviceCheckResult result = rig.run();
    CHECK_FALSE(result.offeredStiffness_N_per_mm());
    CHECK(result.peakForce_N == 0);
  }
  const std::atomic<bool> stop = true;
  Rig rig(touchWith(0.0025), 40, {.stop = &stop});
  CHECK_FALSE(rig.run().offeredStiffness_N_per_mm());
  CHECK(rig.device.times_s.size() <= 2);
}

TEST_CASE("the device test refuses steps that do not ascend") {
  CHECK_THROWS_AS(DeviceCheckQuery({.factor = 1}, {}), UsageError);
  CHECK_THROWS_AS(DeviceCheckQuery({.softest_N_per_mm = 0}, {}), UsageError);
  CHECK_THROWS_AS(DeviceCheckQuery({.softest_N_per_mm = 2, .stiffest_N_per_mm = 1}, {}), UsageError);
  CHECK_THROWS_AS(DeviceCheckQuery({.freeSpace_s = 0}, {}), UsageError);
}

}  // namespace palpate::device_check_test
