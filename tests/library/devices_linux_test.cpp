// A session of the library with a device in a hand: its axes, and what its user agreed to.
// ctest: waits
#include <palpate/palpate.hpp>

#include <algorithm>
#include <chrono>
#include <span>
#include <thread>

#include "tests/library/desk.hpp"
#include "tests/near.hpp"

namespace palpate::library_devices_test {

namespace {

struct Taps {
  double up_mm = 0, towards_mm = 0;  // farthest from the middle
  double stiffness_N_per_mm = 0;     // the most of a hand at rest, where nothing is damped
};
Taps tapsIn(std::span<const pp_tick> ticks) {
  Taps found;
  int still = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const pp_tick& tick = ticks[i];
    still = std::ranges::equal(tick.hip, ticks[i - 1].hip) ? still + 1 : 0;
    found.up_mm = std::max(found.up_mm, 0.6 * std::abs(tick.hip[1]));
    found.towards_mm = std::max(found.towards_mm, 0.6 * std::abs(tick.hip[2]));
    if (still < 20 || tick.contact != 1 || tick.penetration_mm < 0.5) continue;
    const double force_N = std::hypot(tick.force_N[0], tick.force_N[1], tick.force_N[2]);
    found.stiffness_N_per_mm = std::max(found.stiffness_N_per_mm, force_N / tick.penetration_mm);
  }
  return found;
}

/// The hand begins to tap once there are ticks. It goes on until it has felt 0.95 of a stiffness, which takes longer on
/// a machine that stalls, since the force then ramps up again, and for two more taps, so that it would feel more.
/// `read` returns the ticks since the last call, `stop` ends the session.
template <typename Read, typename Stop>
Taps tapsOf(const Desk& desk, double stiffness_N_per_mm, const Read& read, const Stop& stop) {
  std::vector<pp_tick> all;
  const auto readOn = [&] {
    const std::vector<pp_tick> ticks = read();
    all.insert(all.end(), ticks.begin(), ticks.end());
    return !ticks.empty();
  };
  for (int i = 0; i < 3000 && !readOn(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE_FALSE(all.empty());
  desk.tap();
  for (int i = 0; i < 300 && tapsIn(all).stiffness_N_per_mm < 0.95 * stiffness_N_per_mm; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    while (readOn()) {
    }
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  stop();
  while (readOn()) {
  }
  return tapsIn(all);
}

Taps taps(const Desk& desk, pp_session session, const pp_live_options& options, double stiffness_N_per_mm) {
  desk.rest();
  PP_REQUIRE_OK(pp_live_start(session, &options));
  const auto read = [&] {
    std::vector<pp_tick> ticks(512);
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_live_read_ticks(session, ticks.data(), ticks.size(), &count));
    ticks.resize(count);
    return ticks;
  };
  return tapsOf(desk, stiffness_N_per_mm, read, [&] { PP_REQUIRE_OK(pp_live_stop(session)); });
}

}  // namespace

TEST_CASE("a session of the library uses the axes and the stiffness that a device's user agreed to") {
  const Desk desk;
  const OpenBall ball(smallBall());
  const Taps before = taps(desk, ball.session, haply(), 0.8);
  CHECK(before.up_mm == within(40, 1));
  CHECK(before.towards_mm < 2);
  CHECK(before.stiffness_N_per_mm == within(0.8, 0.05));
  desk.agree(R"({"model": "Inverse3 049D", "stiffness_N_per_mm": 0.3, "axes": "z,x,y"})");
  const Taps after = taps(desk, ball.session, haply(), 0.3);
  CHECK(after.up_mm < 2);
  CHECK(after.towards_mm == within(40, 1));
  CHECK(after.stiffness_N_per_mm == within(0.3, 0.02));
}

TEST_CASE("the axes that a program asks for replace those that a device's user agreed to, but not the stiffness") {
  const Desk desk;
  desk.agree(R"({"model": "Inverse3 049D", "stiffness_N_per_mm": 0.3, "axes": "z,x,y"})");
  const OpenBall ball(smallBall());
  pp_live_options options = haply();
  options.axes = "x,y,z";
  const Taps asked = taps(desk, ball.session, options, 0.3);
  CHECK(asked.up_mm == within(40, 1));
  CHECK(asked.towards_mm < 2);
  CHECK(asked.stiffness_N_per_mm == within(0.3, 0.02));
}

TEST_CASE("a session of the C++ header is felt through a device, with the axes that the program asks for") {
  const Desk desk;
  const BallArrays<float> ball(20'000);
  pp::Session session(pp::Cloud(ball.arrays()), smallBall());
  pp_live_options options = haply();
  options.axes = "z,x,y";
  desk.rest();
  session.startLive(options);
  const Taps felt = tapsOf(
      desk, 0.8, [&] { return session.readTicks(); },
      [&] {
        CHECK(session.liveState().running == 1);
        session.stopLive();
      });
  CHECK(felt.up_mm < 2);
  CHECK(felt.towards_mm == within(40, 1));
  CHECK(felt.stiffness_N_per_mm == within(0.8, 0.05));
  options.axes = "x,y";
  CHECK_THROWS_WITH_AS(session.startLive(options), doctest::Contains("'x,y' is not a permutation of x,y,z"), pp::Error);
}

TEST_CASE("axes that are not a permutation, or of a device that is not in a hand, are refused") {
  const Desk desk;
  const OpenBall ball(smallBall());
  pp_live_options options = haply();
  options.axes = "x,y";
  CHECK(pp_live_start(ball.session, &options) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("'x,y' is not a permutation of x,y,z"));
  options.device = "path";
  options.builtin = "press";
  options.axes = "x,z,-y";
  CHECK(pp_live_start(ball.session, &options) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("axes: the device path is not in a hand"));
}

}  // namespace palpate::library_devices_test
