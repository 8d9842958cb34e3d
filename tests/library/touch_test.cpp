// Contact through the C interface, compared with a ball whose surface is known.
#include <algorithm>
#include <limits>

#include "tests/library/ball.hpp"
#include "tests/library/own_law.hpp"
#include "tests/near.hpp"

namespace palpate::touch_test {

namespace {

double radiusOf(const double (&p)[3]) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); }

pp_contact_options contactOf(const char* surface) {
  pp_contact_options contact = pp_default_contact_options();
  contact.surface = surface;
  return contact;
}

}  // namespace

TEST_CASE("a hand in a ball is pushed out along the ball's radius, by stiffness times depth") {
  pp_session_options options = cpuOptions();
  const pp_contact_options contact = contactOf("sphere");
  options.contact = &contact;
  const OpenBall ball(options);
  const auto path = pressPath(1.5);
  const auto ticks = touch(ball.session, pathOf(path));
  REQUIRE(ticks.size() == path.size() / 3);
  CHECK(ticks.front().contact == 0);
  CHECK(lengthOf(ticks.front().force_N) == 0);
  const pp_tick& last = ticks.back();
  CHECK(last.contact == 1);
  CHECK(last.valid == 1);
  CHECK(last.fresh == 1);
  CHECK(last.neighbours > 10);
  CHECK(radiusOf(last.proxy) == near(kBallRadius, 2e-4));
  CHECK(last.penetration_mm == near(kBallRadius - radiusOf(last.hip), 0.01));
  CHECK(lengthOf(last.force_N) == near(0.8 * last.penetration_mm, 1e-6));
  for (int k = 0; k < 3; ++k) {
    CHECK(last.force_N[k] / lengthOf(last.force_N) == within(last.proxy[k] / kBallRadius, 0.01));
    CHECK(last.normal[k] == within(last.proxy[k] / kBallRadius, 0.01));
  }
}

TEST_CASE("a path of three columns has one tick per row, at the row's position, and is repeatable") {
  const OpenBall ball;
  const auto path = pressPath(1, 37, 5);
  const auto ticks = touch(ball.session, pathOf(path));
  REQUIRE(ticks.size() == 42);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    CHECK(ticks[i].t_s == static_cast<double>(i) / 1000);
    for (std::size_t k = 0; k < 3; ++k) CHECK(ticks[i].hip[k] == path[3 * i + k]);
  }
  const auto again = touch(ball.session, pathOf(path));
  CHECK(std::equal(ticks.begin(), ticks.end(), again.begin(), [](const pp_tick& a, const pp_tick& b) {
    return std::equal(std::begin(a.force_N), std::end(a.force_N), b.force_N) &&
           std::equal(std::begin(a.proxy), std::end(a.proxy), b.proxy) && a.neighbours == b.neighbours;
  }));
}

TEST_CASE("each path begins without an earlier contact") {
  const OpenBall ball;
  const std::vector<double> deep{0.3, -0.2, 44};  // far inside, with no points in reach
  CHECK(touch(ball.session, pathOf(deep)).back().contact == 0);
  const auto press = pressPath(1);
  CHECK(touch(ball.session, pathOf(press)).back().contact == 1);
  CHECK(touch(ball.session, pathOf(deep)).back().contact == 0);
}

TEST_CASE("a path with times is linear between its rows, and lasts as long as they say") {
  const OpenBall ball;
  const std::vector<double> rows{0.01, 0, 0, 60, 0.05, 0, 0, 52};
  const auto ticks = touch(ball.session, pathOf(rows, 4));
  REQUIRE(ticks.size() == 51);
  CHECK(ticks[0].hip[2] == 60);
  CHECK(ticks[30].hip[2] == near(56, 1e-6));
  CHECK(ticks[50].hip[2] == near(52, 1e-6));
}

TEST_CASE("paths in single precision and with any row stride give the same ticks") {
  const OpenBall ball;
  const std::vector<double> path{0, 0, 51, 0, 0, 50, 0, 0, 49};
  const std::vector<float> apart{0, 0, 51, -1, 0, 0, 50, -1, 0, 0, 49, -1};
  pp_path narrow = pp_default_path();
  narrow.type = PP_FLOAT32;
  narrow.rows = 3;
  narrow.data = apart.data();
  narrow.stride = 4 * sizeof(float);
  const auto one = touch(ball.session, pathOf(path)), other = touch(ball.session, narrow);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(one[i].hip[2] == other[i].hip[2]);
    CHECK(one[i].force_N[2] == other[i].force_N[2]);
  }
}

TEST_CASE("an invalid path is refused with its row, and nothing is written beyond the array's size") {
  const OpenBall ball;
  std::vector<double> rows{0, 0, 0, 51, 0.01, 0, 0, 50, 0.01, 0, 0, 49};
  std::uint64_t count = 7;
  pp_path path = pathOf(rows, 4);
  PP_CHECK_FAILS(pp_path_ticks(ball.session, &path, &count), PP_ERROR_ARGUMENT, "pose 2 of 3");
  rows[8] = 0.02;
  PP_CHECK_OK(pp_path_ticks(ball.session, &path, &count));
  CHECK(count == 21);
  std::vector<pp_tick> ticks(21, pp_tick{.t_s = -1});
  PP_CHECK_FAILS(pp_session_touch(ball.session, &path, ticks.data(), 20, &count), PP_ERROR_ARGUMENT, "21");
  CHECK(ticks[19].t_s == 0);
  CHECK(ticks[20].t_s == -1);
  rows[11] = std::numeric_limits<double>::infinity();
  CHECK(pp_path_ticks(ball.session, &path, &count) == PP_ERROR_ARGUMENT);
  rows[11] = 49;
  rows[0] = -1;
  CHECK(pp_path_ticks(ball.session, &path, &count) == PP_ERROR_ARGUMENT);
  path.columns = 5;
  CHECK(pp_path_ticks(ball.session, &path, &count) == PP_ERROR_ARGUMENT);
  path.columns = 3;
  path.rows = 0;
  CHECK(pp_path_ticks(ball.session, &path, &count) == PP_ERROR_ARGUMENT);
  path.rows = 4;
  path.type = PP_UINT8;
  CHECK(pp_path_ticks(ball.session, &path, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_touch(ball.session, nullptr, ticks.data(), 20, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_touch(ball.session, &path, nullptr, 20, &count) == PP_ERROR_ARGUMENT);
}

TEST_CASE("session options out of their bounds are refused by their name") {
  const BallCloud ball(100);
  const auto refused = [&](auto&& change, const char* words) {
    pp_session_options options = cpuOptions();
    change(options);
    pp_session session{};
    PP_CHECK_FAILS(pp_session_open(ball.cloud, &options, &session), PP_ERROR_ARGUMENT, words);
    CHECK(session.id == 0);
  };
  refused([](auto& o) { o.rate_Hz = 0; }, "rate_Hz");
  refused([](auto& o) { o.mm_per_unit = -1; }, "mm_per_unit");
  refused([](auto& o) { o.budget_us = -1; }, "budget_us");
  refused([](auto& o) { o.undo_memory_MiB = 0; }, "undo.memory_MiB");
  refused([](auto& o) { o.law_library = "nothing"; }, "LIBRARY:FUNCTION");
  refused([](auto& o) { o.backend = "cuda"; }, "backend: unknown value 'cuda'; choose auto, vulkan, cpu");
  refused([](auto& o) { o.backend = "vulkan"; }, "backend: vulkan conflicts with gpu 'cpu'");
  refused([](auto& o) { o.gpu = "0", o.backend = "cpu"; }, "backend: cpu conflicts with gpu '0'");
  refused([](auto& o) { o.size = 12345; }, "pp_default");
  pp_contact_options contact = contactOf("velvet");
  refused([&](auto& o) { o.contact = &contact; }, "velvet");
  contact = contactOf("sharp");
  contact.stiffness_N_per_mm = 1e9;
  refused([&](auto& o) { o.contact = &contact; }, "stiffness");
  pp_session session{};
  CHECK(pp_session_open(ball.cloud, nullptr, nullptr) == PP_ERROR_ARGUMENT);
  pp_cloud_arrays none = pp_default_cloud_arrays();
  pp_cloud empty{};
  PP_REQUIRE_OK(pp_cloud_create(&none, &empty));
  CHECK(pp_session_open(empty, nullptr, &session) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_cloud_close(empty));
}

TEST_CASE("a session is opened on the back end that is asked for, whether or not a GPU is named") {
  const BallCloud ball(1'000);
  for (const char* gpu : {static_cast<const char*>(nullptr), "cpu"}) {
    pp_session_options options = pp_default_session_options();
    options.gpu = gpu;
    options.backend = gpu ? "auto" : "cpu";
    pp_session session{};
    PP_REQUIRE_OK(pp_session_open(ball.cloud, &options, &session));
    pp_session_info info = pp_default_session_info();
    PP_REQUIRE_OK(pp_session_get_info(session, &info));
    CHECK(std::string(info.backend) == "cpu");
    PP_CHECK_OK(pp_session_close(session));
  }
}

TEST_CASE("a cloud without normals can be felt, and the log function is told that they are estimated") {
  const BallArrays<float> arrays(5'000);
  pp_cloud_arrays bare = arrays.arrays();
  bare.normals = {};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&bare, &cloud));
  std::string heard;
  pp_session_options options = cpuOptions();
  options.log = [](void* user, std::int32_t, const char* line) { *static_cast<std::string*>(user) += line; };
  options.log_user = &heard;
  pp_session session{};
  PP_REQUIRE_OK(pp_session_open(cloud, &options, &session));
  CHECK(heard.find("normals are estimated") != std::string::npos);
  const auto path = pressPath(1.5);
  CHECK(touch(session, pathOf(path)).back().force_N[2] > 0.5);
  PP_CHECK_OK(pp_session_close(session));
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("a hand feels the same tick by tick as along a path") {
  const OpenBall ball;
  const auto path = pressPath(1);
  const auto ticks = touch(ball.session, pathOf(path));
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const pp_pose pose{.t_s = ticks[i].t_s, .hip = {path[3 * i], path[3 * i + 1], path[3 * i + 2]}};
    pp_contact contact{};
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
    CHECK(contact.valid == 1);
    CHECK(contact.contact == ticks[i].contact);
    for (int k = 0; k < 3; ++k) {
      CHECK(contact.proxy[k] == ticks[i].proxy[k]);
      CHECK(contact.force_N[k] == within(ticks[i].force_N[k], 1e-12));
    }
    CHECK(contact.penetration_mm == ticks[i].penetration_mm);
    CHECK(contact.neighbours == ticks[i].neighbours);
  }
  pp_pose pose{.t_s = 1, .hip = {0, 0, std::numeric_limits<double>::quiet_NaN()}};
  pp_contact contact{};
  CHECK(pp_touch(ball.session, &pose, &contact) == PP_ERROR_ARGUMENT);
  CHECK(pp_touch(ball.session, nullptr, &contact) == PP_ERROR_ARGUMENT);
  CHECK(pp_touch(ball.session, &pose, nullptr) == PP_ERROR_ARGUMENT);
}

TEST_CASE("a call that fails leaves no force, count or handle of an earlier one") {
  pp_session closed{};
  const pp_pose inside{.hip = {0.3, -0.2, kBallRadius - 1}};
  pp_contact pressed{};
  {
    const OpenBall ball;
    closed = ball.session;
    constexpr std::size_t kTicks = 100;
    for (std::size_t i = 0; i <= kTicks; ++i) {
      const double share = static_cast<double>(i) / kTicks;
      const pp_pose pose{.t_s = static_cast<double>(i) / 1000, .hip = {0.3, -0.2, kBallRadius + 1 - 2 * share}};
      PP_REQUIRE_OK(pp_touch(ball.session, &pose, &pressed));
    }
    REQUIRE(pressed.force_N[2] > 0.5);
    const auto checkReleased = [&](auto&& call, pp_status expected) {
      pp_contact contact = pressed;
      CHECK(call(contact) == expected);
      CHECK(lengthOf(contact.force_N) == 0);
      CHECK(contact.valid == 0);
      CHECK(contact.contact == 0);
    };
    pp_pose lost = inside;
    lost.hip[0] = std::numeric_limits<double>::quiet_NaN();
    checkReleased([&](pp_contact& to) { return pp_touch(ball.session, &lost, &to); }, PP_ERROR_ARGUMENT);
    checkReleased([&](pp_contact& to) { return pp_touch(ball.session, nullptr, &to); }, PP_ERROR_ARGUMENT);
    checkReleased([&](pp_contact& to) { return pp_touch({}, &inside, &to); }, PP_ERROR_HANDLE);
    const double turn[4]{2, 0, 0, 0};
    double torque_mNm[3]{1, 2, 3};
    checkReleased([&](pp_contact& to) { return pp_touch_hands(ball.session, &inside, turn, 1, &to, torque_mNm); },
                  PP_ERROR_ARGUMENT);
    CHECK(lengthOf(torque_mNm) == 0);
    std::array<pp_contact, 2> both{pressed, pressed};
    const std::array<pp_pose, 2> poses{inside, inside};
    CHECK(pp_touch_hands(ball.session, poses.data(), nullptr, 2, both.data(), nullptr) == PP_ERROR_ARGUMENT);
    CHECK(lengthOf(both[1].force_N) == 0);
  }
  pp_contact contact = pressed;
  CHECK(pp_touch(closed, &inside, &contact) == PP_ERROR_HANDLE);
  CHECK(lengthOf(contact.force_N) == 0);
  pp_session_info info = pp_default_session_info();
  info.points = 7;
  CHECK(pp_session_get_info(closed, &info) == PP_ERROR_HANDLE);
  CHECK(info.points == 0);
  CHECK(info.size == sizeof info);
  std::uint64_t count = 7;
  CHECK(pp_session_undo(closed, 1, &count) == PP_ERROR_HANDLE);
  CHECK(count == 0);
  pp_cloud cloud{7};
  CHECK(pp_cloud_read("/nowhere.ply", nullptr, &cloud) == PP_ERROR_FILE);
  CHECK(cloud.id == 0);
}

TEST_CASE("a time that is not later than that of the pose before is an error, and the contact goes on") {
  const OpenBall ball;
  pp_pose pose{.t_s = 5, .hip = {0.3, -0.2, kBallRadius + 1}};
  pp_contact contact{};
  constexpr std::size_t kTicks = 100;
  for (std::size_t i = 0; i <= kTicks; ++i) {
    pose.t_s = 5 + static_cast<double>(i) / 1000;
    pose.hip[2] = kBallRadius + 1 - 2 * static_cast<double>(i) / kTicks;
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
  }
  const double pressed_N = contact.force_N[2];
  REQUIRE(pressed_N > 0.5);
  const double last_s = pose.t_s;
  for (const double t_s : {last_s, last_s - 0.001, -1.0}) {
    CAPTURE(t_s);
    pose.t_s = t_s;
    PP_CHECK_FAILS(pp_touch(ball.session, &pose, &contact), PP_ERROR_ARGUMENT,
                   "not later than the time of the pose before");
    CHECK(contact.valid == 0);
    CHECK(lengthOf(contact.force_N) == 0);
  }
  pose.t_s = last_s + 0.001;
  PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
  CHECK(contact.force_N[2] == near(pressed_N, 0.1));
  PP_CHECK_OK(pp_touch_lift(ball.session));
  pose = {.t_s = 0, .hip = {0.3, -0.2, kBallRadius + 1}};
  PP_CHECK_OK(pp_touch(ball.session, &pose, &contact));
}

TEST_CASE("a hand lifted and put down inside the ball keeps no contact from before") {
  const OpenBall ball;
  pp_contact contact{};
  const auto at = [&](double t_s, double z) {
    const pp_pose pose{.t_s = t_s, .hip = {0, 0, z}};
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
  };
  at(0, 51);
  at(0.001, 49);
  CHECK(contact.contact == 1);
  PP_CHECK_OK(pp_touch_lift(ball.session));
  at(0.002, 40);  // far inside: no points are in reach
  CHECK(contact.contact == 0);
  CHECK(lengthOf(contact.force_N) == 0);
}

TEST_CASE("contact parameters can be changed in a session, except the support radius") {
  const OpenBall ball;
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
  CHECK(info.points == 20'000);
  CHECK(info.mm_per_unit == 1);
  CHECK(info.radius_mm == near(4 * info.spacing_mm, 0.2));
  CHECK(std::string(info.backend) == "cpu");
  CHECK_FALSE(std::string(info.machine).empty());
  const auto path = pressPath(1);
  const double soft_N = touch(ball.session, pathOf(path)).back().force_N[2];
  pp_contact_options contact = pp_default_contact_options();
  contact.stiffness_N_per_mm = 1.6;
  PP_REQUIRE_OK(pp_session_set_contact(ball.session, &contact));
  CHECK(touch(ball.session, pathOf(path)).back().force_N[2] == near(2 * soft_N, 1e-6));
  contact.max_force_N = 0.5;
  PP_REQUIRE_OK(pp_session_set_contact(ball.session, &contact));
  CHECK(lengthOf(touch(ball.session, pathOf(path)).back().force_N) == near(0.5, 1e-6));
  contact.radius_mm = 3;
  PP_CHECK_FAILS(pp_session_set_contact(ball.session, &contact), PP_ERROR_ARGUMENT, "radius_mm");
}

TEST_CASE("a program's own force law sets the force, within the limits") {
  Calls calls;
  pp_session_options options = cpuOptions();
  options.law = ownLaw;
  options.law_user = &calls;
  const OpenBall ball(options);
  const auto path = pressPath(1);
  const auto ticks = touch(ball.session, pathOf(path));
  CHECK(calls.count > 100);
  CHECK(calls.usual_N == near(0.8 * ticks.back().penetration_mm, 1e-6));
  CHECK(calls.lastHip_z == path.back());
  CHECK(ticks.back().force_N[0] == near(1.25, 1e-6));  // the force of the law, independent of the surface
  CHECK(ticks.back().force_N[2] == within(0, 1e-6));
  calls.size_N = 50;
  CHECK(lengthOf(touch(ball.session, pathOf(path)).back().force_N) == near(3.3, 1e-6));
}

TEST_CASE("a force law that gives no number gives no force, and is reported by the call that meets it") {
  Calls calls;
  pp_session_options options = cpuOptions();
  options.law = ownLaw;
  options.law_user = &calls;
  const OpenBall ball(options);
  const auto path = pressPath(1);
  const pp_path along = pathOf(path);
  std::vector<pp_tick> ticks(path.size() / 3);
  std::uint64_t count = 0;
  for (const double size_N : {std::nan(""), 1e308, -1 / 0.0}) {
    CAPTURE(size_N);
    calls.size_N = size_N;
    PP_CHECK_FAILS(pp_session_touch(ball.session, &along, ticks.data(), ticks.size(), &count), PP_ERROR_FAILED,
                   "law: gave a force that is not finite at ");
    CHECK(count == ticks.size());
    CHECK(ticks.back().contact == 1);
    CHECK(lengthOf(ticks.back().force_N) == 0);
  }
  pp_contact contact{};
  const auto press = [&](double t_s, double depth_mm) {
    const pp_pose pose{.t_s = t_s, .hip = {0.3, -0.2, kBallRadius - depth_mm}, .no_edit = 0, .reserved = 0};
    return pp_touch(ball.session, &pose, &contact);
  };
  PP_CHECK_OK(press(0.001, -2));
  PP_CHECK_FAILS(press(0.002, 1), PP_ERROR_FAILED, "law: gave a force that is not finite at 1 tick, first at 0.002 s");
  CHECK(lengthOf(contact.force_N) == 0);
  CHECK(contact.valid == 0);
  calls.size_N = 1;
  PP_CHECK_OK(press(0.003, 1));
  PP_REQUIRE_OK(pp_session_touch(ball.session, &along, ticks.data(), ticks.size(), &count));
  CHECK(lengthOf(ticks.back().force_N) == near(1, 1e-6));
}

TEST_CASE("the ticks of a path that fails are zero, not those of the path before") {
  const OpenBall ball;
  const auto path = pressPath(1);
  std::vector<pp_tick> ticks = touch(ball.session, pathOf(path));
  REQUIRE(lengthOf(ticks.back().force_N) > 0);
  auto broken = path;
  broken[100] = std::nan("");
  const pp_path along = pathOf(broken);
  std::uint64_t count = 5;
  PP_CHECK_FAILS(pp_session_touch(ball.session, &along, ticks.data(), ticks.size(), &count), PP_ERROR_ARGUMENT, "path");
  CHECK(count == 0);
  for (const pp_tick& tick : ticks) {
    CHECK(tick.contact == 0);
    CHECK(lengthOf(tick.force_N) == 0);
  }
}

TEST_CASE("a force law is loaded from a library by its name") {
  pp_session_options options = cpuOptions();
  const std::string law = std::string(PALPATE_OWN_LAW) + ":half_as_stiff";
  options.law_library = law.c_str();
  const OpenBall ball(options);
  const auto path = pressPath(1);
  const pp_tick last = touch(ball.session, pathOf(path)).back();
  CHECK(last.force_N[2] == near(0.4 * last.penetration_mm, 1e-3));
  const BallCloud other(100);
  pp_session session{};
  const std::string none = std::string(PALPATE_OWN_LAW) + ":nothing";
  options.law_library = none.c_str();
  PP_CHECK_FAILS(pp_session_open(other.cloud, &options, &session), PP_ERROR_FAILED, "has no function nothing");
  options.law_library = "libnowhere.so:law";
  CHECK(pp_session_open(other.cloud, &options, &session) == PP_ERROR_FAILED);
}

}  // namespace palpate::touch_test
