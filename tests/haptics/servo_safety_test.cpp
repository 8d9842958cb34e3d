// The safety list through the whole loop, with a hand-held device.
#include <doctest/doctest.h>

#include <functional>

#include "engine/core/error.hpp"
#include "haptics/devices/path_device.hpp"
#include "tests/haptics/troubled_hands.hpp"
#include "tests/near.hpp"

namespace palpate::servo_safety_test {
namespace {

/// A sphere whose answers a test can change.
class SpoiltSphere final : public OneHandQuery {
 public:
  explicit SpoiltSphere(std::function<void(const Pose&, Contact&)> spoil) : spoil_(std::move(spoil)) {}
  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    Contact contact = sphere_.query(pose, budget_us);
    spoil_(pose, contact);
    return contact;
  }

 private:
  SphereContact sphere_{50};
  std::function<void(const Pose&, Contact&)> spoil_;
};

/// Outside until 0.6 s, then 1 unit deep within 0.1 s, and there until 3 s.
Path press() { return Path({{0, {0, 0, 52}}, {0.6, {0, 0, 52}}, {0.7, {0, 0, 49}}, {3, {0, 0, 49}}}); }

ServoOptions lasting(double duration_s) { return {.duration_s = duration_s}; }

double forceAt(const ServoResult& result, double time_s, double rate_Hz = 1000) {
  return glm::length(result.trace().rows[static_cast<std::size_t>(std::lround(time_s * rate_Hz))].force_N);
}

ServoResult played(HapticDevice& device, const ServoOptions& options = lasting(3)) { return alone(device, options); }

/// Presses on a sphere with spoilt answers.
ServoResult playedOn(SpoiltSphere sphere) {
  TroubledDevice device(press());
  return ServoLoop(device, sphere, ForceLaw({}, {}), lasting(3), kUnbraked).run();
}

}  // namespace

TEST_CASE("a hand outside while forces ramp up feels the full surface afterwards") {
  TroubledDevice device(press());
  const ServoResult result = played(device);
  CHECK(forceAt(result, 0.5) == 0);
  CHECK(forceAt(result, 2) == near(0.8, 1e-6));
  CHECK(result.counts().withheld.errors + result.counts().withheld.stale + result.counts().withheld.hot == 0);
}

TEST_CASE("a hand inside when the session starts feels nothing until it has been outside") {
  const Path path({{0, {0, 0, 49}}, {1, {0, 0, 49}}, {1.1, {0, 0, 51}}, {1.2, {0, 0, 49}}, {3, {0, 0, 49}}});
  TroubledDevice held(path);
  double rate_Hz = 1000;
  SUBCASE("at 1 kHz") {}
  SUBCASE("at 10 kHz, where the slew limit makes every first force small") { rate_Hz = 10'000; }
  ServoOptions options = lasting(3);
  options.rate_Hz = rate_Hz;
  const ServoResult result = played(held, options);
  for (const TraceRow& row : result.trace().rows) {
    if (row.time_s <= 1) REQUIRE(row.force_N == DVec3(0));
  }
  CHECK(forceAt(result, 1.25, rate_Hz) > 0.05);
  CHECK(forceAt(result, 1.25, rate_Hz) < 0.4);
  CHECK(forceAt(result, 2, rate_Hz) == near(0.8, 1e-6));
}

TEST_CASE("a script feels the full force from its first tick, and may jump") {
  PathDevice device(Path({{0, {0, 0, 49}}, {0.1, {0, 0, 49}}, {0.101, {0, 0, 80}}, {0.102, {0, 0, 49}}}));
  const ServoResult result = played(device, {.duration_s = 0.2});
  CHECK(forceAt(result, 0.01) == near(0.8, 1e-6));
  CHECK(forceAt(result, 0.19) == near(0.8, 1e-6));
  CHECK_FALSE(result.counts().leastEnergy_mJ);
}

TEST_CASE("a device that jumps farther than a hand can move gives no force until it has been outside") {
  const auto jumping = [](double to) {
    return Path({{0, {0, 0, 60}}, {0.8, {0, 0, 60}}, {0.801, {0, 0, to}}, {3, {0, 0, to}}});
  };
  TroubledDevice thrown(jumping(56)), lost(jumping(48.5));
  CHECK(played(thrown).counts().withheld.errors == 0);  // 4 mm in a tick: fast, but possible for a hand
  const ServoResult result = played(lost);
  CHECK(result.counts().withheld.errors == 1);
  for (const TraceRow& row : result.trace().rows) REQUIRE(row.force_N == DVec3(0));
}

TEST_CASE("answers that are never fresh lose their force, even if they claim to be valid") {
  const ServoResult result = playedOn(
      SpoiltSphere([](const Pose& pose, Contact& contact) { contact.fresh = pose.time_s < 1 || pose.time_s >= 2; }));
  CHECK(forceAt(result, 1.015) == near(0.8, 1e-6));
  CHECK(forceAt(result, 1.08) == 0);
  CHECK(forceAt(result, 1.99) == 0);
  CHECK(forceAt(result, 2.1) < 0.2);
  CHECK(forceAt(result, 2.6) == near(0.8, 1e-6));
}

TEST_CASE("answers that are always a tick late, and report it, keep their force") {
  const ServoResult result = playedOn(SpoiltSphere([](const Pose& pose, Contact& contact) {
    contact.fresh = false;
    contact.dataTime_s = std::max(0.0, pose.time_s - 0.001);
  }));
  CHECK(forceAt(result, 2) == near(0.8, 1e-6));
  CHECK(result.counts().withheld.stale == 0);
}

TEST_CASE("a query that fails for good gives zero force for good") {
  const ServoResult result =
      playedOn(SpoiltSphere([](const Pose& pose, Contact& contact) { contact.valid = pose.time_s < 1; }));
  CHECK(forceAt(result, 0.999) == near(0.8, 1e-6));
  for (std::size_t i = 1000; i < 3000; ++i) REQUIRE(result.trace().rows[i].force_N == DVec3(0));
}

TEST_CASE("the force switch stops the force at once and restores it slowly") {
  TroubledDevice device(Path({{0, {0, 0, 52}},
                              {0.6, {0, 0, 52}},
                              {0.7, {0, 0, 49}},
                              {1.5, {0, 0, 49}},
                              {1.6, {0, 0, 51}},
                              {1.7, {0, 0, 49}},
                              {3, {0, 0, 49}}}));
  SphereContact sphere(50);
  std::atomic<bool> on = true;
  ServoOptions options = lasting(3);
  options.forcesOn = &on;
  ServoLoop loop(device, sphere, ForceLaw({}, {}), options, kUnbraked);
  const ServoResult result = loop.run([&](const TraceRow& row) { on = row.time_s < 1 || row.time_s > 1.2; });
  CHECK(forceAt(result, 1) == near(0.8, 1e-6));
  CHECK(forceAt(result, 1.001) == 0);
  CHECK(forceAt(result, 1.45) == 0);  // on again, but the hand is still inside
  CHECK(forceAt(result, 1.7) < 0.4);
  CHECK(forceAt(result, 2.5) == near(0.8, 1e-6));
  CHECK(result.trace().rows[1300].contact);
}

TEST_CASE("motors driven too hard for too long get the continuous force") {
  TroubledDevice device(Path({{0, {0, 0, 52}}, {0.6, {0, 0, 52}}, {0.7, {0, 0, 44}}, {12, {0, 0, 44}}}));
  const ServoResult result = played(device, lasting(12));
  CHECK(forceAt(result, 1) == near(3.3, 1e-6));
  CHECK(forceAt(result, 11.9) == near(0.88, 0.01));
  CHECK(result.counts().withheld.hot > 5000);
  CHECK_FALSE(result.trace().rows[1000].hot);
  CHECK(result.trace().rows.back().hot);
  for (std::size_t i = 1000; i < result.trace().rows.size(); ++i)
    REQUIRE(glm::distance(result.trace().rows[i].force_N, result.trace().rows[i - 1].force_N) < 0.02);
}

TEST_CASE("a passivity controller requires a device that yields") {
  PathDevice script(press());
  SphereContact sphere(50);
  const auto made = [&](PassivityMode mode) {
    return ServoLoop(script, sphere, ForceLaw({}, {}), lasting(3), {.passivity = mode});
  };
  CHECK_THROWS_AS(made(PassivityMode::on), UsageError);
  const ServoResult result = made(PassivityMode::observe).run();
  REQUIRE(result.counts().leastEnergy_mJ);
  CHECK(*result.counts().leastEnergy_mJ == 0);  // it only pressed
}

}  // namespace palpate::servo_safety_test
