// Several hands, and tools of many points: by path, tick by tick and live.
#include <array>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <thread>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::hands_test {

namespace {

pp_session_options handsOptions(std::uint32_t hands) {
  pp_session_options options = cpuOptions();
  options.hands = hands;
  return options;
}

// Onto the ball from the side of an axis, and at rest there.
std::vector<double> pressAlong(std::size_t axis, double sign, double depth_mm, std::size_t ticks = 200) {
  std::vector<double> path;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / 100);
    std::array<double, 3> place{0.3, -0.2, 0.1};
    place[axis] = sign * (kBallRadius + 2 - share * (2 + depth_mm));
    path.insert(path.end(), place.begin(), place.end());
  }
  return path;
}

struct Ran {
  std::vector<pp_tick> ticks;
  std::vector<double> torques_mNm;
};

Ran runHands(pp_session session, const std::vector<pp_path>& paths, const pp_brush* brush = nullptr) {
  std::vector<const pp_path*> given;
  std::uint64_t most = 0;
  for (const pp_path& path : paths) {
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_path_ticks(session, &path, &count));
    most = std::max(most, count);
    given.push_back(&path);
  }
  Ran ran{std::vector<pp_tick>(most * paths.size()), std::vector<double>(3 * most * paths.size(), 7)};
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_touch_hands(session, given.data(), static_cast<std::uint32_t>(given.size()), brush,
                                       ran.ticks.data(), ran.torques_mNm.data(), ran.ticks.size(), &count));
  CHECK(count == ran.ticks.size());
  return ran;
}

}  // namespace

TEST_CASE("each of several hands feels what it would feel alone, and rests at the end of its path") {
  const OpenBall three(handsOptions(3));
  const auto top = pressAlong(2, 1, 1), side = pressAlong(0, -1, 2), early = pressAlong(1, 1, 1.5, 150);
  const Ran ran = runHands(three.session, {pathOf(top), pathOf(side), pathOf(early)});
  REQUIRE(ran.ticks.size() == 600);
  const OpenBall alone;
  const std::array<std::vector<double>, 3> ways{top, side, early};
  for (std::size_t hand = 0; hand < 3; ++hand) {
    const auto single = touch(alone.session, pathOf(ways[hand]));
    for (std::size_t i = 0; i < single.size(); ++i) {
      const pp_tick& tick = ran.ticks[3 * i + hand];
      CHECK(tick.t_s == single[i].t_s);
      CHECK(std::memcmp(tick.hip, single[i].hip, sizeof tick.hip) == 0);
      CHECK(tick.force_N[0] == within(single[i].force_N[0], 1e-9));
      CHECK(tick.force_N[2] == within(single[i].force_N[2], 1e-9));
    }
  }
  const pp_tick& stays = ran.ticks[3 * 199 + 2];
  CHECK(stays.hip[1] == near(kBallRadius - 1.5, 1e-6));
  CHECK(stays.contact == 1);
  CHECK(ran.ticks[3 * 199 + 1].force_N[0] < -1);                   // away from the ball, to its own side
  for (const double torque : ran.torques_mNm) CHECK(torque == 0);  // points have no torque
}

TEST_CASE("the first of two hands sculpts, the second only feels, and the stroke can be undone") {
  const OpenBall two(handsOptions(2));
  const auto before = placesOf(two.session);
  const auto top = pressAlong(2, 1, 4), bottom = pressAlong(2, -1, 4);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  runHands(two.session, {pathOf(top), pathOf(bottom)}, &brush);
  const auto after = placesOf(two.session);
  double above = 0, below = 0;
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    const double moved = std::abs(after[i] - before[i]);
    (before[i - i % 3 + 2] > 0 ? above : below) += moved;
  }
  CHECK(above > 1);
  CHECK(below == 0);
  PP_REQUIRE_OK(pp_session_undo(two.session, 10, nullptr));
  CHECK(placesOf(two.session) == before);
}

TEST_CASE("a host's own loop queries two hands in one call") {
  const OpenBall two(handsOptions(2));
  std::array<pp_contact, 2> contacts{};
  std::array<double, 6> torques{1, 1, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 150; ++i) {
    const double z = 52 - 0.03 * std::min<double>(static_cast<double>(i), 100);
    const std::array<pp_pose, 2> poses{pp_pose{.t_s = 1e-3 * static_cast<double>(i), .hip = {0.3, -0.2, z}},
                                       pp_pose{.t_s = 99, .hip = {-z, 0.1, 0.2}}};
    PP_REQUIRE_OK(pp_touch_hands(two.session, poses.data(), nullptr, 2, contacts.data(), torques.data()));
  }
  CHECK(contacts[0].contact == 1);
  CHECK(contacts[0].force_N[2] > 0.5);
  CHECK(std::abs(contacts[0].force_N[0]) < 0.1);
  CHECK(contacts[1].force_N[0] < -0.5);
  CHECK(std::abs(contacts[1].force_N[2]) < 0.1);
  for (const double torque : torques) CHECK(torque == 0);
  PP_REQUIRE_OK(pp_touch_lift(two.session));
}

TEST_CASE("a program built before hands and tools were added has one hand with a point") {
  pp_tool tool = pp_default_tool();
  tool.kind = "nonsense that an old program does not know of";
  pp_session_options options = handsOptions(3);
  options.tool = &tool;
  options.size = offsetof(pp_session_options, hands);
  const OpenBall old(options);
  const auto top = pressAlong(2, 1, 1);
  CHECK(touch(old.session, pathOf(top)).back().contact == 1);
  pp_session_options newer{};
  pp_init_session_options(&newer, offsetof(pp_session_options, hands));
  CHECK(newer.hands == 0);  // nothing is written beyond its size
  CHECK(newer.rate_Hz == 1000);
}

TEST_CASE("incompatible hands, poses and paths are refused, and the session stays usable") {
  pp_session session{};
  const BallCloud cloud(2'000);
  pp_session_options options = handsOptions(9);
  PP_CHECK_FAILS(pp_session_open(cloud.cloud, &options, &session), PP_ERROR_ARGUMENT, "hands");
  const OpenBall two(handsOptions(2));
  const auto top = pressAlong(2, 1, 1);
  const pp_path path = pathOf(top);
  std::vector<pp_tick> ticks(400);
  std::uint64_t count = 0;
  PP_CHECK_FAILS(pp_session_touch(two.session, &path, ticks.data(), ticks.size(), &count), PP_ERROR_ARGUMENT,
                 "2 hands");
  const pp_path* const paths[]{&path, &path, &path};
  CHECK(pp_session_touch_hands(two.session, paths, 3, nullptr, ticks.data(), nullptr, 400, &count) ==
        PP_ERROR_ARGUMENT);
  CHECK(pp_session_touch_hands(two.session, nullptr, 2, nullptr, ticks.data(), nullptr, 400, &count) ==
        PP_ERROR_ARGUMENT);
  PP_CHECK_FAILS(pp_session_touch_hands(two.session, paths, 2, nullptr, ticks.data(), nullptr, 399, &count),
                 PP_ERROR_ARGUMENT, "capacity");
  const pp_path* const missing[]{&path, nullptr};
  CHECK(pp_session_touch_hands(two.session, missing, 2, nullptr, ticks.data(), nullptr, 400, &count) ==
        PP_ERROR_ARGUMENT);
  std::array<pp_pose, 2> poses{};
  std::array<pp_contact, 2> contacts{};
  CHECK(pp_touch(two.session, poses.data(), contacts.data()) == PP_ERROR_ARGUMENT);
  CHECK(pp_touch_hands(two.session, poses.data(), nullptr, 1, contacts.data(), nullptr) == PP_ERROR_ARGUMENT);
  CHECK(pp_touch_hands(two.session, nullptr, nullptr, 2, contacts.data(), nullptr) == PP_ERROR_ARGUMENT);
  poses[1].hip[0] = std::nan("");
  CHECK(pp_touch_hands(two.session, poses.data(), nullptr, 2, contacts.data(), nullptr) == PP_ERROR_ARGUMENT);
  poses[1].hip[0] = 0;
  const std::array<double, 8> orientations{1, 0, 0, 0, 2, 0, 0, 0};
  PP_CHECK_FAILS(pp_touch_hands(two.session, poses.data(), orientations.data(), 2, contacts.data(), nullptr),
                 PP_ERROR_ARGUMENT, "quaternion");
  PP_CHECK_OK(pp_session_touch_hands(two.session, paths, 2, nullptr, ticks.data(), nullptr, 400, &count));
  CHECK(count == 400);
}

TEST_CASE("live hands have one row each in every tick, at the same times") {
  const OpenBall two(handsOptions(2));
  const std::vector<double> down{0, 0, 0, 52, 0.1, 0, 0, 49}, in{0, -52, 0, 0, 0.1, -48, 0, 0};
  const pp_path first = pathOf(down, 4), second = pathOf(in, 4);
  pp_live_options options = pp_default_live_options(), other = pp_default_live_options();
  options.path = &first;
  options.rate_Hz = 500;
  CHECK(pp_live_start(two.session, &options) == PP_ERROR_ARGUMENT);  // the second path is missing
  CHECK(lastErrorSays("the session has 2"));
  other.path = &second;
  options.next = &other;
  other.rate_Hz = 250;
  CHECK(pp_live_start(two.session, &options) == PP_ERROR_ARGUMENT);
  other.rate_Hz = 0;
  pp_live_options third = other;
  other.next = &third;
  CHECK(pp_live_start(two.session, &options) == PP_ERROR_ARGUMENT);
  other.next = nullptr;
  PP_REQUIRE_OK(pp_live_start(two.session, &options));
  std::vector<pp_tick> all;
  const auto arePressed = [&] { return all[all.size() - 2].force_N[2] > 0.5 && all.back().force_N[0] < -1; };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while ((all.size() < 300 || !arePressed()) && std::chrono::steady_clock::now() < end) {
    std::vector<pp_tick> ticks(33);  // an odd number: the last row stays unused
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_live_read_ticks(two.session, ticks.data(), ticks.size(), &count));
    REQUIRE(count % 2 == 0);
    all.insert(all.end(), ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  REQUIRE(all.size() >= 300);
  for (std::size_t i = 0; i < all.size(); i += 2) {
    CHECK(all[i].t_s == all[i + 1].t_s);
    if (i > 0) CHECK(all[i].t_s > all[i - 2].t_s);
    CHECK(all[i].hip[0] == 0);
    CHECK(all[i + 1].hip[2] == 0);
  }
  CHECK(all[all.size() - 2].force_N[2] > 0.5);
  CHECK(all.back().force_N[0] < -1);
  pp_live_state state = pp_default_live_state();
  PP_REQUIRE_OK(pp_live_get_state(two.session, &state));
  CHECK(state.ticks == all.size() / 2);
  PP_REQUIRE_OK(pp_live_stop(two.session));
}

TEST_CASE("a pad touches with many points, gives a torque at an edge, and is no stiffer than a point") {
  pp_tool tool = pp_default_tool();
  tool.kind = "pad";
  tool.points = 16;
  tool.size_mm = 10;
  pp_session_options options = cpuOptions();
  options.tool = &tool;
  const OpenBall padded(options);
  const auto top = pressAlong(2, 1, 2);
  const Ran felt = runHands(padded.session, {pathOf(top)});
  const OpenBall pointed;
  const double point_N = touch(pointed.session, pathOf(top)).back().force_N[2];
  const double pad_N = felt.ticks.back().force_N[2];
  CHECK(pad_N > 0.2);
  CHECK(pad_N < point_N);
  // Beside the top of the ball the pad is pressed at one side, which gives a torque.
  pp_contact contact{};
  std::array<double, 3> torque{};
  const std::array<double, 4> straight{1, 0, 0, 0}, about{0, 1, 0, 0};
  const auto poseAt = [](int i) { return pp_pose{.t_s = 1e-3 * i, .hip = {8, 0, std::max(48.0, 54 - 0.1 * i)}}; };
  for (int i = 0; i < 100; ++i) {
    const pp_pose now = poseAt(i);
    PP_REQUIRE_OK(pp_touch_hands(padded.session, &now, straight.data(), 1, &contact, torque.data()));
  }
  const double beside_mNm = std::hypot(torque[0], torque[1], torque[2]);
  CHECK(contact.force_N[2] > 0.1);
  CHECK(beside_mNm > 0.1);
  // Rotated by 180 degrees about x its face points up, and another part of it is in the ball.
  for (int i = 100; i < 150; ++i) {
    const pp_pose now = poseAt(i);
    PP_REQUIRE_OK(pp_touch_hands(padded.session, &now, about.data(), 1, &contact, torque.data()));
  }
  CHECK(std::abs(std::hypot(torque[0], torque[1], torque[2]) - beside_mNm) > 1e-3);

  const BallCloud cloud(2'000);
  pp_session session{};
  tool.kind = "spoon";
  PP_CHECK_FAILS(pp_session_open(cloud.cloud, &options, &session), PP_ERROR_ARGUMENT, "spatula");
  tool.kind = "ball";
  for (const std::uint32_t points : {0u, 65u}) {
    tool.points = points;
    CHECK(pp_session_open(cloud.cloud, &options, &session) == PP_ERROR_ARGUMENT);
  }
  tool.points = 8;
  tool.size_mm = -1;
  CHECK(pp_session_open(cloud.cloud, &options, &session) == PP_ERROR_ARGUMENT);
  tool.size_mm = 5;
  tool.axis[0] = tool.axis[1] = tool.axis[2] = 0;
  PP_CHECK_FAILS(pp_session_open(cloud.cloud, &options, &session), PP_ERROR_ARGUMENT, "axis");
}

}  // namespace palpate::hands_test
