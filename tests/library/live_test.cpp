// The library's own servo thread: ticks in blocks, its force law, its edits, and its end.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "tests/labels.hpp"
#include "tests/library/ball.hpp"
#include "tests/library/own_law.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::live_test {

namespace {

/// Takes ticks until at least `wanted`, or until 20 s have passed.
std::vector<pp_tick> readTicks(pp_session session, std::size_t wanted, std::size_t block = 64) {
  std::vector<pp_tick> all;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (all.size() < wanted && std::chrono::steady_clock::now() < end) {
    std::vector<pp_tick> ticks(block);
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_live_read_ticks(session, ticks.data(), ticks.size(), &count));
    REQUIRE(count <= block);
    all.insert(all.end(), ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return all;
}

pp_live_options along(const pp_path& path) {
  pp_live_options options = pp_default_live_options();
  options.path = &path;
  options.rate_Hz = 500;
  return options;
}

}  // namespace

TEST_CASE("a live hand follows its path in real time, and each tick is received once, in order") {
  const OpenBall ball;
  const std::vector<double> rows{0, 0, 0, 52, 0.1, 0, 0, 49};
  const pp_path path = pathOf(rows, 4);
  const pp_live_options options = along(path);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
  CHECK(info.live == 1);
  const auto isPressed = [](const pp_tick& tick) {
    return tick.contact == 1 && tick.force_N[2] == within(0.8 * tick.penetration_mm, 0.008 * tick.penetration_mm);
  };
  auto ticks = readTicks(ball.session, 150);
  // After a stall of the machine the force returns gradually.
  for (int i = 0; i < 100 && !(ticks.size() >= 150 && isPressed(ticks.back())); ++i) {
    const auto more = readTicks(ball.session, 50);
    ticks.insert(ticks.end(), more.begin(), more.end());
  }
  REQUIRE(ticks.size() >= 150);
  for (std::size_t i = 1; i < ticks.size(); ++i) CHECK(ticks[i].t_s > ticks[i - 1].t_s);
  const pp_tick& last = ticks.back();
  CHECK(last.contact == 1);
  CHECK(last.hip[2] == near(49, 1e-6));
  CHECK(last.force_N[2] == near(0.8 * last.penetration_mm, 0.01));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  pp_live_state state = pp_default_live_state();
  readTicks(ball.session, 1);
  PP_REQUIRE_OK(pp_live_get_state(ball.session, &state));
  CHECK(state.running == 0);
  CHECK(state.ticks >= ticks.size());
  std::uint64_t count = 1;
  pp_tick tick{};
  while (count > 0) PP_REQUIRE_OK(pp_live_read_ticks(ball.session, &tick, 1, &count));
}

TEST_CASE("a live session refuses conflicting calls, and works again after it is stopped") {
  const OpenBall ball;
  const auto press = pressPath(1);
  const pp_path path = pathOf(press);
  const pp_live_options options = along(path);
  std::uint64_t count = 0;
  pp_tick tick{};
  CHECK(pp_live_read_ticks(ball.session, &tick, 1, &count) == PP_ERROR_STATE);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  CHECK(pp_live_start(ball.session, &options) == PP_ERROR_STATE);
  std::vector<pp_tick> ticks(200);
  PP_CHECK_FAILS(pp_session_touch(ball.session, &path, ticks.data(), ticks.size(), &count), PP_ERROR_STATE,
                 "the session is live; stop it first");
  const pp_brush first = pp_default_brush();
  PP_CHECK_FAILS(pp_session_set_brush(ball.session, &first), PP_ERROR_STATE, "before the session is live");
  PP_CHECK_FAILS(pp_session_record(ball.session, "log"), PP_ERROR_STATE, "before it is live");
  const pp_pose pose{.t_s = 0, .hip = {0, 0, 49}};
  pp_contact contact{};
  CHECK(pp_touch(ball.session, &pose, &contact) == PP_ERROR_STATE);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  CHECK(touch(ball.session, path).size() == 200);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));  // closing the session stops it
}

TEST_CASE("a live hand sculpts with the brush of its session, and all strokes can be undone") {
  const OpenBall ball;
  const auto before = placesOf(ball.session);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  const std::vector<double> rows{0, 0, 0, 52, 0.1, 0, 0, 46, 0.8, 0, 0, 46, 0.9, 0, 0, 60};
  const pp_path path = pathOf(rows, 4);
  const pp_live_options options = along(path);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  readTicks(ball.session, 500);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  CHECK(placesOf(ball.session) != before);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 100, nullptr));
  CHECK(placesOf(ball.session) == before);
}

TEST_CASE("a live session takes commands of several threads while it is read, and its force goes on") {
  const ScratchFolder folder;
  const OpenBall ball;
  const auto before = placesOf(ball.session);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, nullptr));
  const std::string log = (folder / "log").string();
  PP_REQUIRE_OK(pp_session_record(ball.session, log.c_str()));
  const std::vector<double> rows{0, 0, 0, 52, 0.1, 0, 0, 48.5};
  const pp_path path = pathOf(rows, 4);
  const pp_live_options options = along(path);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  readTicks(ball.session, 100);

  std::atomic<bool> isOver = false;
  std::atomic<int> failures = 0;
  const auto repeat = [&](const std::function<pp_status(int)>& command) {
    return std::jthread([&, command] {
      for (int i = 0; i < 20; ++i) failures += command(i) != PP_OK;
    });
  };
  std::vector<pp_tick> ticks;
  {
    std::jthread reader([&] {
      while (!isOver) {
        const auto more = readTicks(ball.session, 1);
        ticks.insert(ticks.end(), more.begin(), more.end());
      }
    });
    {
      const std::jthread sculpts = repeat([&](int i) {
        pp_brush next = brush;
        next.radius_mm = 4 + 0.1 * i;
        return pp_session_set_brush(ball.session, i % 3 ? &next : nullptr);
      });
      const std::jthread feels = repeat([&](int i) {
        pp_contact_options contact = pp_default_contact_options();
        contact.stiffness_N_per_mm = 0.5 + 0.02 * i;
        return pp_session_set_contact(ball.session, &contact);
      });
      const std::jthread goesBack = repeat([&](int i) {
        return i % 2 ? pp_session_undo(ball.session, 1, nullptr) : pp_session_redo(ball.session, 1, nullptr);
      });
      const std::jthread looks = repeat([&](int) {
        pp_cloud cloud{};
        const pp_status status = pp_session_cloud(ball.session, &cloud);
        pp_cloud_close(cloud);
        return status;
      });
    }
    isOver = true;
  }
  CHECK(failures == 0);
  REQUIRE(ticks.size() > 10);
  const auto isFree = [](const pp_tick& tick) { return lengthOf(tick.force_N) == 0; };
  // A stall of the machine takes the force away, too.
  bool hasStalled = false;
  for (std::size_t i = 1; i < ticks.size(); ++i) hasStalled = hasStalled || ticks[i].t_s - ticks[i - 1].t_s > 0.04;
  if (!hasStalled) CHECK(std::ranges::none_of(ticks, isFree));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));  // after the end, as before
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1000, nullptr));
  CHECK(placesOf(ball.session) == before);
  pp_recording recording{};
  PP_REQUIRE_OK(pp_recording_read(log.c_str(), &recording));
  pp_recording_close(recording);
}

TEST_CASE("a first brush after a live session builds the session again, and its ticks can still be taken") {
  const OpenBall ball;
  const auto press = pressPath(1);
  const pp_path path = pathOf(press);
  const pp_live_options options = along(path);
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  readTicks(ball.session, 20);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
  CHECK(info.live == 0);
  pp_live_state state = pp_default_live_state();
  PP_REQUIRE_OK(pp_live_get_state(ball.session, &state));
  CHECK(state.running == 0);
  std::uint64_t count = 1;
  pp_tick tick{};
  while (count > 0) PP_REQUIRE_OK(pp_live_read_ticks(ball.session, &tick, 1, &count));
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  CHECK(readTicks(ball.session, 20).size() >= 20);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
}

TEST_CASE("a live tick comes with the torque of its tool and the age of its contact") {
  pp_tool pad = pp_default_tool();
  pad.kind = "pad";
  pad.points = 8;
  pad.size_mm = 10;
  pp_session_options options = cpuOptions();
  options.tool = &pad;
  const OpenBall ball(options);
  const std::vector<double> rows{0, 5, 0, 52, 0.05, 5, 0, 48};
  const pp_path path = pathOf(rows, 4);
  const pp_live_options live = along(path);
  PP_REQUIRE_OK(pp_live_start(ball.session, &live));
  std::vector<pp_tick> ticks(64);
  std::vector<double> torques_mNm(3 * ticks.size()), ages_s(ticks.size());
  pp_live_rows all = pp_default_live_rows();
  all.capacity = ticks.size();
  all.ticks = ticks.data();
  all.torques_mNm = torques_mNm.data();
  all.ages_s = ages_s.data();
  double most_mNm = 0;
  std::size_t wrongAges = 0;
  CHECK(comes(10, [&] {
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_live_read_rows(ball.session, &all, &count));
    for (std::size_t i = 0; i < count; ++i) {
      most_mNm = std::max(most_mNm, std::hypot(torques_mNm[3 * i], torques_mNm[3 * i + 1]));
      wrongAges += ticks[i].valid && (ticks[i].fresh ? ages_s[i] != 0 : ages_s[i] == 0);
    }
    return most_mNm > 0.1;
  }));
  CHECK(wrongAges == 0);
  std::uint64_t count = 1;
  all.ticks = nullptr;
  CHECK(pp_live_read_rows(ball.session, &all, &count) == PP_ERROR_ARGUMENT);
  CHECK(count == 0);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
}

TEST_CASE("forces can be switched off and on, with a force law, while the hand moves") {
  Calls calls;
  const OpenBall ball;
  // Forces that are switched on stay zero until the hand has been outside: it moves in and out.
  std::vector<double> rows{0, 0, 0, 51};
  for (int i = 0; i < 60; ++i) {
    const double begin_s = 0.9 * i;
    rows.insert(rows.end(),
                {begin_s + 0.02, 0, 0, 49, begin_s + 0.5, 0, 0, 49, begin_s + 0.6, 0, 0, 55, begin_s + 0.8, 0, 0, 55});
  }
  const pp_path path = pathOf(rows, 4);
  pp_live_options options = along(path);
  options.law = ownLaw;
  options.law_user = &calls;
  PP_REQUIRE_OK(pp_live_set_forces(ball.session, 0));
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  const auto without = readTicks(ball.session, 60, 8);
  CHECK(std::ranges::all_of(without, [](const pp_tick& tick) { return lengthOf(tick.force_N) == 0; }));
  CHECK(std::ranges::all_of(without, [](const pp_tick& tick) { return tick.withheld == tick.contact; }));
  CHECK(std::ranges::any_of(without, [](const pp_tick& tick) { return tick.contact == 1; }));
  PP_REQUIRE_OK(pp_live_set_forces(ball.session, 1));
  double most_N = 0;
  int withheld = 1;
  for (int i = 0; i < 15 && most_N < 1.24; ++i)
    for (const pp_tick& tick : readTicks(ball.session, 900)) {
      if (tick.force_N[0] > most_N) withheld = tick.withheld;
      most_N = std::max(most_N, tick.force_N[0]);
    }
  CHECK(most_N == near(1.25, 1e-6));
  CHECK(withheld == 0);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  CHECK(calls.count > 100);
}

TEST_CASE("a command to a live session whose tick hangs returns a timeout, changes nothing, and the next one works" *
          kFull) {
  const OpenBall ball;
  const std::vector<double> rows{0, 0, 0, 52, 0.1, 0, 0, 49};
  const pp_path path = pathOf(rows, 4);
  pp_live_options options = along(path);
  struct {
    std::atomic<bool> hangs = true, isReached = false;
  } tick;
  options.law = [](void* user, const pp_pose*, const pp_contact*, double, double*) {
    auto& its = *static_cast<decltype(tick)*>(user);
    its.isReached = true;
    while (its.hangs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  options.law_user = &tick;
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  while (!tick.isReached) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  pp_contact_options contact = pp_default_contact_options();
  contact.stiffness_N_per_mm = 0.5;
  CHECK(pp_session_set_contact(ball.session, &contact) == PP_ERROR_TIMEOUT);
  CHECK(std::string(pp_last_error()).find("withdrawn") != std::string::npos);
  tick.hangs = false;
  PP_CHECK_OK(pp_session_set_contact(ball.session, &contact));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
}

TEST_CASE("a missing device and incompatible options are refused with an error") {
  const OpenBall ball;
  pp_live_options options = pp_default_live_options();
  CHECK(pp_live_start(ball.session, nullptr) == PP_ERROR_ARGUMENT);  // the default device, path, without a path
  options.device = "mouse-of-glass";
  PP_CHECK_FAILS(pp_live_start(ball.session, &options), PP_ERROR_ARGUMENT, "mouse-of-glass");
  // No driver of this vendor is installed where tests run.
  options.device = "dhd";
  CHECK(pp_live_start(ball.session, &options) == PP_ERROR_DEVICE);
  options.device = "sim";
  CHECK(pp_live_start(ball.session, &options) == PP_ERROR_ARGUMENT);
  options.builtin = "nothing";
  CHECK(pp_live_start(ball.session, &options) != PP_OK);
  options.builtin = "press";
  options.rate_Hz = 1e9;
  PP_CHECK_FAILS(pp_live_start(ball.session, &options), PP_ERROR_ARGUMENT, "rate_Hz");
  options.rate_Hz = 0;
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));  // a simulated stylus, moved by a simulated hand
  CHECK(readTicks(ball.session, 100).size() >= 100);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
}

}  // namespace palpate::live_test
