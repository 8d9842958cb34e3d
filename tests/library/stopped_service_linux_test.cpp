// A Haply service that is stopped (SIGSTOP) while the hand presses, and continued.
// ctest: waits
#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/labels.hpp"
#include "tests/library/desk.hpp"
#include "tests/near.hpp"

namespace palpate::stopped_service_test {

namespace {

constexpr double kStiffness_N_per_mm = 0.2;
/// A force that returns does so over half a second; no tick exceeds that ramp by more than a surface changes a force.
constexpr double kRamp_s = 0.5, kRise_N = 0.06;
/// Of the device: without a state for that long it has no force; without one for a second it is lost.
constexpr double kSilent_s = 0.02, kLost_s = 1, kTwoTicks_s = 0.002;

struct Held {
  OpenBall ball;
  std::vector<pp_tick> ticks;

  Held() : ball(options()) {}
  static pp_session_options options() {
    static pp_contact_options contact = pp_default_contact_options();
    contact.stiffness_N_per_mm = kStiffness_N_per_mm;
    contact.damping_N_s_per_mm = 0;
    pp_session_options all = smallBall();
    all.contact = &contact;
    return all;
  }
  pp_status read() {
    pp_status status = PP_OK;
    for (std::uint64_t count = 1; count > 0 && status == PP_OK;) {
      std::vector<pp_tick> more(512);
      status = pp_live_read_ticks(ball.session, more.data(), more.size(), &count);
      if (status == PP_OK) ticks.insert(ticks.end(), more.begin(), more.begin() + static_cast<std::ptrdiff_t>(count));
    }
    return status;
  }
  /// Until the last tick's force is at least that.
  bool presses(double force_N) {
    return comes(30, [&] {
      PP_REQUIRE_OK(read());
      return !ticks.empty() && lengthOf(ticks.back().force_N) >= force_N;
    });
  }
  double now_s() {
    const std::size_t before = ticks.size();
    REQUIRE(comes(10, [&] {
      PP_REQUIRE_OK(read());
      return ticks.size() > before;
    }));
    return ticks.back().t_s;
  }
};

/// The hand taps, and has been pressing for a moment.
void begin(Held& held, const Desk& desk) {
  desk.rest();
  const pp_live_options live = haply();
  PP_REQUIRE_OK(pp_live_start(held.ball.session, &live));
  held.now_s();
  desk.tap();
  REQUIRE(held.presses(0.4));
}

/// The last tick with another position of the hand than the tick before: of a moving hand the last state that came.
double silentSince_s(const std::vector<pp_tick>& ticks, double until_s) {
  double since_s = -1;
  for (std::size_t i = 1; i < ticks.size() && ticks[i].t_s < until_s; ++i)
    if (!std::ranges::equal(ticks[i].hip, ticks[i - 1].hip)) since_s = ticks[i].t_s;
  return since_s;
}

double most_N(const std::vector<pp_tick>& ticks, double from_s, double to_s) {
  double most = 0;
  for (const pp_tick& tick : ticks)
    if (tick.t_s > from_s && tick.t_s < to_s) most = std::max(most, lengthOf(tick.force_N));
  return most;
}

}  // namespace

TEST_CASE("a stopped Haply service takes the force after 20 ms, and it returns in free space without a jump" * kClock) {
  Desk desk;
  double stop_s = 0, resume_s = 0;
  Held held;
  begin(held, desk);
  desk.send(SIGSTOP);
  stop_s = held.now_s();
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  resume_s = held.now_s();
  desk.send(SIGCONT);
  REQUIRE(comes(30, [&] {  // it taps again
    PP_REQUIRE_OK(held.read());
    return most_N(held.ticks, resume_s, 1e9) > 0.4;
  }));
  PP_REQUIRE_OK(pp_live_stop(held.ball.session));
  held.read();
  const double silent_s = std::max(stop_s, silentSince_s(held.ticks, resume_s));
  CHECK(resume_s - silent_s > 0.3);
  CHECK(silent_s - stop_s < 0.1);
  CHECK(most_N(held.ticks, silent_s + kSilent_s + kTwoTicks_s, resume_s) == 0);
  // Whoever presses feels nothing until the hand has been outside; then the force ramps up.
  const auto after = std::ranges::find_if(held.ticks, [&](const pp_tick& tick) { return tick.t_s > resume_s; });
  const auto felt =
      std::find_if(after, held.ticks.end(), [](const pp_tick& tick) { return lengthOf(tick.force_N) > 0; });
  const auto outside =
      std::find_if(after, held.ticks.end(), [](const pp_tick& tick) { return tick.valid && !tick.contact; });
  REQUIRE(felt != held.ticks.end());
  CHECK(outside < felt);
  for (auto tick = felt; tick != held.ticks.end(); ++tick) {
    const double share = std::min(1.0, (tick->t_s - outside->t_s) / kRamp_s);
    CHECK_MESSAGE(lengthOf(tick->force_N) <= share * kStiffness_N_per_mm * tick->penetration_mm + kRise_N, tick->t_s);
  }
  // What came to the service: the one force that was under way when it was stopped, and zeros.
  const Desk::Received received = desk.leave();
  CHECK(received.most_N > 0.3);
  CHECK(received.last_N == 0);
  CHECK(received.gap_s > 0.3);
  CHECK(received.forcesAfterGap <= 1);
}

TEST_CASE("a Haply service that stays stopped ends the live session after a second, in words" * kClock) {
  Desk desk;
  Held held;
  begin(held, desk);
  desk.send(SIGSTOP);
  const double stop_s = held.now_s();
  pp_status status = PP_OK;
  CHECK(comes(10, [&] { return (status = held.read()) != PP_OK; }));
  CHECK(status == PP_ERROR_DEVICE);
  CHECK_MESSAGE(lastErrorSays("gives no data (red light)"), std::string(pp_last_error()));
  const double silent_s = std::max(stop_s, silentSince_s(held.ticks, 1e9));
  CHECK(silent_s - stop_s < 0.1);
  CHECK(most_N(held.ticks, silent_s + kSilent_s + kTwoTicks_s, 1e9) == 0);
  CHECK(held.ticks.back().t_s - silent_s == within(kLost_s, 0.1));
  pp_live_state state = pp_default_live_state();
  PP_CHECK_OK(pp_live_get_state(held.ball.session, &state));
  CHECK(state.running == 0);
  // Neither the end of the session nor another start hangs at a service that does not answer.
  const auto since = std::chrono::steady_clock::now();
  pp_live_stop(held.ball.session);
  const pp_live_options live = haply();
  CHECK(pp_live_start(held.ball.session, &live) == PP_ERROR_DEVICE);
  CHECK(std::chrono::steady_clock::now() - since < std::chrono::seconds(5));
  desk.send(SIGCONT);
  PP_CHECK_OK(pp_live_start(held.ball.session, &live));
  held.now_s();
  PP_REQUIRE_OK(pp_live_stop(held.ball.session));
  CHECK(desk.leave().last_N == 0);
}

}  // namespace palpate::stopped_service_test
