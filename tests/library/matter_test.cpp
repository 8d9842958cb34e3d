// Simulated matter: alone, under hands by path, tick by tick and live; its parameters, points and end.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::matter_test {

namespace {

// Small enough for a thousand steps in a second or two.
constexpr const char* kTank =
    R"({"matter": "water", "box_mm": [80, 120, 80], "fill_mm": [80, 70, 80], "spacing_mm": 10,
        "tool": {"radius_mm": 20, "mass_kg": 0.034}})";

/// A scene in a file that exists during a test.
struct SceneFile {
  std::filesystem::path file;
  explicit SceneFile(const std::string& json = kTank)
      : file(std::filesystem::temp_directory_path() /
             ("palpate_scene_" + std::to_string(std::hash<std::thread::id>{}(std::this_thread::get_id())) + ".json")) {
    std::ofstream(file) << json;
  }
  ~SceneFile() { std::filesystem::remove(file); }
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;
  std::string name() const { return file.string(); }
};

struct OpenScene {
  pp_session session{};
  explicit OpenScene(const std::string& scene, pp_session_options options = cpuOptions()) {
    PP_REQUIRE_OK(pp_session_open_matter(scene.c_str(), &options, &session));
  }
  ~OpenScene() { pp_session_close(session); }
  OpenScene(const OpenScene&) = delete;
  OpenScene& operator=(const OpenScene&) = delete;
};

struct LoneMatter {
  pp_matter matter{};
  explicit LoneMatter(const std::string& scene, std::uint32_t threads = 2) {
    pp_matter_options options = pp_default_matter_options();
    options.gpu = "cpu";
    options.threads = threads;
    PP_REQUIRE_OK(pp_matter_open(scene.c_str(), &options, &matter));
  }
  ~LoneMatter() { pp_matter_close(matter); }
  LoneMatter(const LoneMatter&) = delete;
  LoneMatter& operator=(const LoneMatter&) = delete;
};

// Into the water, and at rest there.
std::vector<double> dive(std::size_t down = 300, std::size_t rest = 200, double x = 40) {
  std::vector<double> path;
  for (std::size_t i = 0; i < down + rest; ++i)
    path.insert(path.end(), {x, 100 - 65 * std::min(1.0, static_cast<double>(i) / static_cast<double>(down)), 40});
  return path;
}

struct Frame {
  double t_s = 0;
  std::uint64_t moving = 0;
  std::vector<float> positions, velocities;

  explicit Frame(pp_frame frame) {
    pp_moving_points points{};
    PP_REQUIRE_OK(pp_frame_view(frame, &points));
    REQUIRE(points.points.count > 0);
    t_s = points.t_s;
    moving = points.moving;
    const std::size_t numbers = 3 * points.points.count;
    positions.assign(points.points.positions, points.points.positions + numbers);
    velocities.assign(points.velocities, points.velocities + numbers);
    PP_REQUIRE_OK(pp_frame_close(frame));
    CHECK(pp_frame_view(frame, &points) == PP_ERROR_HANDLE);
  }
  double fastest() const {
    double most = 0;
    for (const float v : velocities) most = std::max(most, std::abs(static_cast<double>(v)));
    return most;
  }
};

Frame frameOf(pp_session session) {
  pp_frame frame{};
  PP_REQUIRE_OK(pp_session_frame(session, &frame));
  pp_moving_points points{};
  PP_REQUIRE_OK(pp_frame_view(frame, &points));
  CHECK(points.points.normals != nullptr);
  return Frame(frame);
}
Frame frameOf(pp_matter matter) {
  pp_frame frame{};
  PP_REQUIRE_OK(pp_matter_frame(matter, &frame));
  return Frame(frame);
}

std::map<std::string, pp_parameter> parametersOf(pp_session session) {
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_parameter_count(session, &count));
  std::map<std::string, pp_parameter> all;
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_parameter parameter{};
    PP_REQUIRE_OK(pp_session_get_parameter(session, i, &parameter));
    all[parameter.name] = parameter;
  }
  pp_parameter none{};
  CHECK(pp_session_get_parameter(session, count, &none) == PP_ERROR_ARGUMENT);
  return all;
}

pp_motion motionOf(pp_session session) {
  pp_motion motion = pp_default_motion();
  PP_REQUIRE_OK(pp_session_get_motion(session, &motion));
  return motion;
}

pp_matter_state stateOf(pp_matter matter) {
  pp_matter_state state = pp_default_matter_state();
  PP_REQUIRE_OK(pp_matter_get_state(matter, &state));
  return state;
}

// kThin is so fine and weightless that each step is one substep: a beating hand exceeds its speed of sound.
constexpr const char* kCoarse =
    R"({"matter": "water", "box_mm": [80, 120, 80], "fill_mm": [80, 70, 80], "spacing_mm": 16,
        "tool": {"radius_mm": 20, "mass_kg": 0.034}})";
constexpr const char* kThin = R"({"matter": "water", "box_mm": [16, 16, 16], "fill_mm": [16, 16, 16], "spacing_mm": 2,
                                  "gravity_m_s2": [0, 0, 0]})";

}  // namespace

TEST_CASE("matter without a hand advances by milliseconds, the same for any number of threads") {
  const SceneFile scene(R"({"matter": "water", "box_mm": [120, 80, 40], "fill_mm": [50, 60, 40], "spacing_mm": 8})");
  const LoneMatter one(scene.name(), 1), two(scene.name(), 2);
  const Frame rest = frameOf(one.matter);
  CHECK(rest.t_s == 0);
  CHECK(rest.fastest() == 0);
  PP_REQUIRE_OK(pp_matter_step(one.matter, 150));
  for (int k = 0; k < 150; ++k) PP_REQUIRE_OK(pp_matter_step(two.matter, 1));
  const Frame a = frameOf(one.matter), b = frameOf(two.matter);
  CHECK(a.t_s == near(0.15, 1e-6));
  CHECK(a.positions == b.positions);
  CHECK(a.velocities == b.velocities);
  CHECK(a.positions != rest.positions);
  const pp_matter_state state = stateOf(one.matter);
  CHECK(state.particles * 3 == a.positions.size());
  CHECK(state.t_s == a.t_s);
  CHECK(state.kinetic_J > 0);
  CHECK(state.front_mm > 55);  // it flows into the empty part
  CHECK(state.front_mm <= 120);
  CHECK(state.substeps > 0);
  // Velocities are in mm/s, positions in mm: a step of one millisecond is consistent with both.
  PP_REQUIRE_OK(pp_matter_step(one.matter, 1));
  const Frame next = frameOf(one.matter);
  double worst = 0, fastest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    const double moved = static_cast<double>(next.positions[i]) - static_cast<double>(a.positions[i]);
    worst = std::max(worst, std::abs(moved - 1e-3 * static_cast<double>(next.velocities[i])));
    fastest = std::max(fastest, std::abs(moved));
  }
  CHECK(fastest > 0.2);
  CHECK(worst < 0.4 * fastest);  // water that hits a wall
  PP_REQUIRE_OK(pp_matter_reset(one.matter));
  CHECK(frameOf(one.matter).positions == rest.positions);
  PP_REQUIRE_OK(pp_matter_step(one.matter, 150));
  CHECK(frameOf(one.matter).positions == a.positions);
}

TEST_CASE("parameters of matter without a hand are listed, set within their bounds, and take effect") {
  const SceneFile scene;
  const LoneMatter still(scene.name()), falling(scene.name());
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_matter_parameter_count(still.matter, &count));
  CHECK(count >= 4);
  bool found = false;
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_parameter parameter{};
    PP_REQUIRE_OK(pp_matter_get_parameter(still.matter, i, &parameter));
    if (std::string(parameter.name) != "gravity_y_m_s2") continue;
    found = true;
    CHECK(parameter.value == near(-9.81, 1e-6));
    CHECK(std::string(parameter.unit) == "m/s^2");
  }
  CHECK(found);
  PP_REQUIRE_OK(pp_matter_set_parameter(falling.matter, "gravity_x_m_s2", 15));
  PP_REQUIRE_OK(pp_matter_step(still.matter, 60));
  PP_REQUIRE_OK(pp_matter_step(falling.matter, 60));
  CHECK(stateOf(falling.matter).momentum_kg_m_s[0] > 5 * std::abs(stateOf(still.matter).momentum_kg_m_s[0]) + 1e-3);
  CHECK(pp_matter_set_parameter(still.matter, "gravity_y_m_s2", 1e9) == PP_ERROR_ARGUMENT);
  CHECK(pp_matter_set_parameter(still.matter, "gravity_y_m_s2", std::nan("")) == PP_ERROR_ARGUMENT);
  PP_CHECK_FAILS(pp_matter_set_parameter(still.matter, "taste", 1), PP_ERROR_ARGUMENT,
                 "viscosity_Pa_s");  // it lists the known ones
  CHECK(pp_matter_set_parameter(still.matter, nullptr, 1) == PP_ERROR_ARGUMENT);
}

TEST_CASE("missing scenes and calls that do not apply to a session are refused with an error") {
  pp_session session{};
  pp_matter matter{};
  const pp_session_options options = cpuOptions();
  PP_CHECK_FAILS(pp_session_open_matter("lava", &options, &session), PP_ERROR_ARGUMENT, "water");
  CHECK(pp_matter_open("lava", nullptr, &matter) == PP_ERROR_ARGUMENT);
  CHECK(pp_matter_open(nullptr, nullptr, &matter) == PP_ERROR_ARGUMENT);
  CHECK(pp_matter_open("water", nullptr, nullptr) == PP_ERROR_ARGUMENT);
  const SceneFile broken(R"({"matter": "water", "box_mm": [80, 120]})");
  PP_CHECK_FAILS(pp_session_open_matter(broken.name().c_str(), &options, &session), PP_ERROR_FILE, "fill_mm");
  const SceneFile huge(
      R"({"matter": "water", "box_mm": [9000, 9000, 9000], "fill_mm": [9000, 9000, 9000], "spacing_mm": 1})");
  CHECK(pp_matter_open(huge.name().c_str(), nullptr, &matter) != PP_OK);
  CHECK(matter.id == 0);
  CHECK(session.id == 0);

  const OpenBall ball;
  pp_frame frame{};
  pp_motion motion = pp_default_motion();
  CHECK(pp_session_frame(ball.session, &frame) == PP_ERROR_STATE);
  CHECK(pp_session_pause(ball.session, 1) == PP_ERROR_STATE);
  CHECK(pp_session_reset(ball.session) == PP_ERROR_STATE);
  CHECK(pp_session_get_motion(ball.session, &motion) == PP_ERROR_STATE);
  PP_CHECK_FAILS(pp_session_set_parameter(ball.session, "gain", 1), PP_ERROR_STATE, "a scene of matter");

  const SceneFile tank;
  const OpenScene water(tank.name());
  pp_brush brush = pp_default_brush();
  CHECK(pp_session_set_brush(water.session, &brush) == PP_ERROR_ARGUMENT);
  PP_CHECK_FAILS(pp_matter_step({water.session.id}, 1), PP_ERROR_HANDLE, "session");
  motion.size = 3;
  CHECK(pp_session_get_motion(water.session, &motion) == PP_ERROR_ARGUMENT);
  pp_session_options padded = cpuOptions();
  pp_tool tool = pp_default_tool();
  tool.kind = "pad";
  padded.tool = &tool;
  CHECK(pp_session_open_matter(tank.name().c_str(), &padded, &session) == PP_ERROR_ARGUMENT);
}

TEST_CASE("a hand by path feels the water, time continues from path to path, and a reset restarts it") {
  const SceneFile scene;
  const OpenScene water(scene.name());
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(water.session, &info));
  CHECK(info.mm_per_unit == 1);
  const Frame rest = frameOf(water.session);
  CHECK(rest.positions.size() == 3 * info.points);
  const auto way = dive();
  const auto first = touch(water.session, pathOf(way));
  const pp_tick& last = first.back();
  CHECK(last.contact == 1);
  CHECK(last.force_N[1] > 0.1);  // it is pushed up
  CHECK(lengthOf(first.front().force_N) == 0);
  const Frame under = frameOf(water.session);
  CHECK(under.t_s == near(last.t_s, 1e-6));
  CHECK(under.positions != rest.positions);
  const pp_motion motion = motionOf(water.session);
  CHECK(motion.hands == 1);
  CHECK(motion.failed == 0);
  CHECK(motion.energy_J[0] > 0);                                // work was done on the water
  CHECK(motion.min_energy_J[0] > -0.005 * motion.energy_J[0]);  // during the ramp of the force
  // Continues from there, not from the start.
  const std::vector<double> stay{40, 35, 40, 40, 35, 40};
  const auto more = touch(water.session, pathOf(stay));
  CHECK(more.front().t_s == near(last.t_s + 1e-3, 1e-6));
  CHECK(more.front().force_N[1] == near(last.force_N[1], 0.2));
  // The same path after a reset gives the same bits.
  PP_REQUIRE_OK(pp_session_reset(water.session));
  const auto again = touch(water.session, pathOf(way));
  REQUIRE(again.size() == first.size());
  for (std::size_t i = 0; i < again.size(); ++i)
    CHECK(std::memcmp(again[i].force_N, first[i].force_N, sizeof first[i].force_N) == 0);
}

TEST_CASE("paused matter is not felt and does not move, and parameters act while it runs") {
  const SceneFile scene;
  const OpenScene water(scene.name());
  const auto way = dive(200, 100);
  PP_REQUIRE_OK(pp_session_pause(water.session, 1));
  CHECK(motionOf(water.session).paused == 1);
  const Frame before = frameOf(water.session);
  for (const pp_tick& tick : touch(water.session, pathOf(way))) CHECK(lengthOf(tick.force_N) == 0);
  const Frame after = frameOf(water.session);
  for (std::size_t i = 0; i < after.positions.size(); ++i)
    CHECK(after.positions[i] == within(before.positions[i], 1e-5));
  PP_REQUIRE_OK(pp_session_pause(water.session, 0));
  PP_REQUIRE_OK(pp_session_reset(water.session));
  const double plain_N = touch(water.session, pathOf(way)).back().force_N[1];
  const auto parameters = parametersOf(water.session);
  REQUIRE(parameters.contains("gain"));
  CHECK(parameters.at("gain").value == 1);
  PP_REQUIRE_OK(pp_session_set_parameter(water.session, "gain", 3));
  CHECK(parametersOf(water.session).at("gain").value == 3);
  PP_REQUIRE_OK(pp_session_reset(water.session));
  const double gained_N = touch(water.session, pathOf(way)).back().force_N[1];
  CHECK(gained_N == near(3 * plain_N, 0.15));
  CHECK(pp_session_set_parameter(water.session, "gain", -5) == PP_ERROR_ARGUMENT);
  CHECK(parametersOf(water.session).at("gain").value == 3);
}

TEST_CASE("a host's own loop feels water tick by tick, with or without a time budget") {
  const SceneFile scene;
  pp_session_options options = cpuOptions();
  SUBCASE("without a budget") {}
  SUBCASE("with a budget") { options.budget_us = 100'000; }
  const OpenScene water(scene.name(), options);
  pp_contact contact{};
  for (std::size_t i = 0; i < 400; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / 300);
    const pp_pose pose{.t_s = 1e-3 * static_cast<double>(i), .hip = {40, 100 - 65 * share, 40}};
    PP_REQUIRE_OK(pp_touch(water.session, &pose, &contact));
    CHECK(contact.valid == 1);
  }
  CHECK(contact.contact == 1);
  CHECK(contact.force_N[1] > 0.1);
  // A path starts at the time that the loop has reached.
  const std::vector<double> stay{40, 35, 40};
  CHECK(touch(water.session, pathOf(stay)).front().t_s == near(0.4, 1e-6));
}

TEST_CASE("a live hand in water gives ticks and new frames, while another thread sets parameters") {
  // Small enough for a busy machine to answer before the force of the last answer has faded.
  const SceneFile scene(kCoarse);
  pp_session_options options = cpuOptions();
  options.threads = 1;
  const OpenScene water(scene.name(), options);
  const std::vector<double> rows{0, 40, 100, 40, 0.3, 40, 35, 40};
  const pp_path path = pathOf(rows, 4);
  pp_live_options live = pp_default_live_options();
  live.path = &path;
  live.rate_Hz = 500;
  PP_REQUIRE_OK(pp_live_start(water.session, &live));
  std::atomic<int> wrong = 0;
  std::thread governor([&] {
    for (int k = 0; k < 20; ++k) {
      pp_motion motion = pp_default_motion();
      const auto ok = [](pp_status status) { return status == PP_OK || status == PP_ERROR_THREAD; };
      wrong += !ok(pp_session_get_motion(water.session, &motion));
      wrong += !ok(pp_session_set_parameter(water.session, "viscosity_Pa_s", 0.01 * k));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  std::vector<pp_tick> all;
  double most_N = 0;  // on a slow machine the last answer fades, and the test waits for another one
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while ((all.size() < 250 || most_N <= 0.05) && std::chrono::steady_clock::now() < end) {
    std::vector<pp_tick> ticks(64);
    std::uint64_t count = 0;
    const pp_status status = pp_live_read_ticks(water.session, ticks.data(), ticks.size(), &count);
    if (status == PP_ERROR_THREAD) continue;  // the other thread is in a call
    PP_REQUIRE_OK(status);
    all.insert(all.end(), ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::uint64_t i = 0; i < count; ++i) most_N = std::max(most_N, ticks[i].force_N[1]);
    if (count == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  governor.join();
  CHECK(wrong == 0);
  const Frame one = frameOf(water.session);
  Frame two = frameOf(water.session);
  for (const auto later = std::chrono::steady_clock::now() + std::chrono::seconds(30);
       two.t_s <= one.t_s + 0.05 && std::chrono::steady_clock::now() < later; two = frameOf(water.session))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(two.t_s > one.t_s + 0.05);
  CHECK(two.positions != one.positions);
  PP_REQUIRE_OK(pp_live_stop(water.session));
  REQUIRE(all.size() >= 250);
  CHECK(most_N > 0.05);
}

TEST_CASE("matter that diverges gives an error by path and a zero force by tick, until it is reset") {
  const SceneFile scene(kThin);
  const OpenScene water(scene.name());
  std::vector<double> wild;
  for (int i = 0; i < 1000; ++i) wild.insert(wild.end(), {8.0, i % 4 < 2 ? 16.0 : 0.0, 8.0});
  const pp_path path = pathOf(wild);
  std::vector<pp_tick> ticks(1000);
  std::uint64_t count = 0;
  REQUIRE(pp_session_touch(water.session, &path, ticks.data(), ticks.size(), &count) == PP_ERROR_SIMULATION);
  CHECK(lastErrorSays("diverged"));
  const pp_motion failed = motionOf(water.session);
  CHECK(failed.failed == 1);
  CHECK(std::string(failed.failure).find("diverged") != std::string::npos);
  const auto calm = dive(30, 10);
  const pp_path way = pathOf(calm);
  CHECK(pp_session_touch(water.session, &way, ticks.data(), ticks.size(), &count) == PP_ERROR_SIMULATION);
  const pp_pose pose{.t_s = 10, .hip = {40, 40, 40}};
  pp_contact contact{};
  PP_REQUIRE_OK(pp_touch(water.session, &pose, &contact));
  CHECK(contact.valid == 0);
  CHECK(lengthOf(contact.force_N) == 0);
  PP_REQUIRE_OK(pp_session_reset(water.session));
  PP_REQUIRE_OK(pp_touch(water.session, &pose, &contact));
  CHECK(contact.valid == 1);
  CHECK(motionOf(water.session).failed == 0);
}

TEST_CASE("a soft body is felt, sculpted by a brush, and the stroke can be undone") {
  const SceneFile scene(R"({"matter": "soft", "box_mm": [120, 120, 120], "fill_mm": [60, 40, 60], "spacing_mm": 10,
                            "young_Pa": 20000})");
  const OpenScene jelly(scene.name());
  std::vector<double> press;
  for (int i = 0; i < 300; ++i) press.insert(press.end(), {60, std::max(34.0, 48 - 0.07 * i), 60});
  const auto felt = touch(jelly.session, pathOf(press));
  CHECK(felt.back().contact == 1);
  CHECK(felt.back().force_N[1] > 0.05);
  const Frame pressed = frameOf(jelly.session);
  CHECK(pressed.moving * 3 == pressed.positions.size());
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 15;
  const auto before = placesOf(jelly.session);
  stroke(jelly.session, pathOf(press), brush);
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(jelly.session, &info));
  CHECK(info.undo_count == 1);
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(jelly.session, 1, &done));
  CHECK(done == 1);
  PP_REQUIRE_OK(pp_session_get_info(jelly.session, &info));
  CHECK(info.undo_count == 0);
  CHECK(info.redo_count == 1);
}

TEST_CASE("invalid handles of matter and frames are refused, and a frame outlives its matter") {
  const SceneFile scene;
  pp_matter closed{};
  pp_frame frame{};
  {
    const LoneMatter matter(scene.name());
    closed = matter.matter;
    PP_REQUIRE_OK(pp_matter_frame(closed, &frame));
  }
  CHECK(pp_matter_step(closed, 1) == PP_ERROR_HANDLE);
  CHECK(pp_matter_close(closed) == PP_ERROR_HANDLE);
  CHECK(pp_matter_reset({}) == PP_ERROR_HANDLE);
  CHECK(pp_frame_close({closed.id}) == PP_ERROR_HANDLE);
  const Frame outlives(frame);  // its matter is closed
  CHECK(outlives.fastest() == 0);
  CHECK(pp_frame_close(frame) == PP_ERROR_HANDLE);
}

}  // namespace palpate::matter_test
