// Session logs: recorded by path and live, read into arrays, replayed bit by bit; and invalid logs.
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/content_of.hpp"
#include "tests/library/ball.hpp"
#include "tests/library/own_law.hpp"
#include "tests/library/simulating.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::logs_test {

namespace {

struct ReadLog {
  pp_recording log{};
  pp_recording_content content{};
  explicit ReadLog(const std::filesystem::path& file) {
    PP_REQUIRE_OK(pp_recording_read(file.string().c_str(), &log));
    PP_REQUIRE_OK(pp_recording_view(log, &content));
  }
  ~ReadLog() { pp_recording_close(log); }
  ReadLog(const ReadLog&) = delete;
  ReadLog& operator=(const ReadLog&) = delete;
};

pp_replay_result replay(const std::filesystem::path& file, pp_cloud cloud) {
  pp_replay_options options = pp_default_replay_options();
  options.cloud = cloud;
  options.threads = 2;
  pp_replay_result result = pp_default_replay_result();
  PP_REQUIRE_OK(pp_recording_replay(file.string().c_str(), &options, &result));
  return result;
}

}  // namespace

TEST_CASE("a path without a brush is recorded, read tick by tick, and replayed bit by bit") {
  const ScratchFolder folder;
  const auto file = folder.path() / "felt.session";
  const OpenBall ball;
  const auto press = pressPath(1.5);
  PP_REQUIRE_OK(pp_session_record(ball.session, file.string().c_str()));
  const auto ticks = touch(ball.session, pathOf(press));
  {
    const ReadLog log(file);
    REQUIRE(log.content.ticks == ticks.size());
    CHECK(log.content.ended == 1);
    CHECK(log.content.edits == 0);
    CHECK(log.content.points == 20'000);
    CHECK(std::string(log.content.missing).empty());
    CHECK(std::string(log.content.header).find("\"cpu\"") != std::string::npos);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      const pp_recording_tick& tick = log.content.tick[i];
      CHECK(tick.t_s == ticks[i].t_s);
      CHECK(std::memcmp(tick.force_N, ticks[i].force_N, sizeof tick.force_N) == 0);
      CHECK(std::memcmp(tick.proxy, ticks[i].proxy, sizeof tick.proxy) == 0);
      for (int k = 0; k < 3; ++k)
        CHECK(log.content.map_scale * tick.device[k] + log.content.map_offset[k] == ticks[i].hip[k]);
      CHECK(tick.contact == ticks[i].contact);
      CHECK(tick.neighbours == ticks[i].neighbours);
      CHECK(tick.orientation[0] == 1);
    }
  }
  const pp_replay_result result = replay(file, ball.cloud.cloud);
  CHECK(result.identical == 1);
  CHECK(result.compared == ticks.size());
  CHECK(result.ticks == ticks.size());
  CHECK(result.force_ticks == 0);
  CHECK(result.first_difference_s < 0);
  CHECK(result.recorded_edits == 1);
  // Only that path was recorded.
  const std::string bytes = contentOf(file);
  touch(ball.session, pathOf(press));
  CHECK(contentOf(file) == bytes);
}

TEST_CASE("a stroke is recorded with all its edits of points, and replayed bit by bit") {
  const ScratchFolder folder;
  const auto file = folder.path() / "dent.session";
  const OpenBall ball;
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  SUBCASE("push") { brush.kind = "push"; }
  SUBCASE("carve") {
    brush.kind = "carve";
    brush.strength = 1;
  }
  SUBCASE("paint") { brush.kind = "paint"; }
  PP_REQUIRE_OK(pp_session_record(ball.session, file.string().c_str()));
  const auto press = pressPath(4, 150, 50);
  stroke(ball.session, pathOf(press), brush);
  {
    const ReadLog log(file);
    CHECK(log.content.edits > 10);
    CHECK(log.content.tick[log.content.ticks - 1].edits <= log.content.edits);
    std::uint64_t changed = 0;
    for (std::uint64_t i = 0; i < log.content.edits; ++i) {
      const pp_recording_edit& edit = log.content.edit[i];
      const double radius = std::hypot(edit.position[0], edit.position[1], edit.position[2]);
      const bool painted = edit.color[0] != 0 || edit.color[3] != 0;
      changed += edit.gone == 1 || std::abs(radius - kBallRadius) > 1e-3 || painted;
      CHECK(std::hypot(edit.normal[0], edit.normal[1], edit.normal[2]) == near(1, 1e-3));
    }
    CHECK(changed > log.content.edits / 4);
  }
  CHECK(replay(file, ball.cloud.cloud).identical == 1);
  // After edits no log can begin.
  PP_CHECK_FAILS(pp_session_record(ball.session, file.string().c_str()), PP_ERROR_STATE, "edited");
}

TEST_CASE("a log contains the name of its model file, and is replayed without naming it") {
  const ScratchFolder folder;
  const auto model = folder.path() / "ball.ply", file = folder.path() / "felt.session";
  const BallCloud made(5'000);
  PP_REQUIRE_OK(pp_cloud_write(made.cloud, model.string().c_str(), nullptr));
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_read(model.string().c_str(), nullptr, &cloud));
  pp_session session{};
  const pp_session_options options = cpuOptions();
  PP_REQUIRE_OK(pp_session_open(cloud, &options, &session));
  PP_REQUIRE_OK(pp_session_record(session, file.string().c_str()));
  const auto press = pressPath(1);
  touch(session, pathOf(press));
  PP_REQUIRE_OK(pp_session_close(session));
  CHECK(replay(file, {}).identical == 1);
  CHECK(replay(file, cloud).identical == 1);
  // Another model is detected.
  const BallCloud other(4'999);
  pp_replay_options wrong = pp_default_replay_options();
  wrong.cloud = other.cloud;
  pp_replay_result result = pp_default_replay_result();
  PP_CHECK_FAILS(pp_recording_replay(file.string().c_str(), &wrong, &result), PP_ERROR_ARGUMENT,
                 "cloud: has 4999 points");
  std::filesystem::remove(model);
  PP_CHECK_FAILS(pp_recording_replay(file.string().c_str(), nullptr, &result), PP_ERROR_FILE, "does not exist");
  PP_REQUIRE_OK(pp_cloud_close(cloud));
}

TEST_CASE("matter is recorded from its start, and replayed bit by bit without its scene file") {
  if (!canSimulate()) return;
  const ScratchFolder folder;
  const auto scene = folder.path() / "tank.json", file = folder.path() / "tank.session";
  std::ofstream(scene) << R"({"matter": "water", "box_mm": [80, 120, 80], "fill_mm": [80, 70, 80], "spacing_mm": 10})";
  pp_session session{};
  const pp_session_options options = cpuOptions();
  PP_REQUIRE_OK(pp_session_open_matter(scene.string().c_str(), &options, &session));
  std::vector<double> dive;
  for (int i = 0; i < 200; ++i) dive.insert(dive.end(), {40, std::max(40.0, 100 - 0.4 * i), 40});
  touch(session, pathOf(dive));
  PP_REQUIRE_OK(pp_session_set_parameter(session, "viscosity_Pa_s", 0.3));
  PP_REQUIRE_OK(pp_session_record(session, file.string().c_str()));
  const auto ticks = touch(session, pathOf(dive));
  CHECK(ticks.front().t_s == 0);
  PP_REQUIRE_OK(pp_session_close(session));
  std::filesystem::remove(scene);  // the log contains the scene
  const pp_replay_result result = replay(file, {});
  CHECK(result.identical == 1);
  CHECK(result.compared == ticks.size());
}

TEST_CASE("a live session is recorded until it stops, and replayed as far as its answers were on time") {
  const ScratchFolder folder;
  const auto file = folder.path() / "live.session";
  const OpenBall ball;
  const std::vector<double> rows{0, 0, 0, 52, 0.1, 0, 0, 49};
  const pp_path path = pathOf(rows, 4);
  pp_live_options live = pp_default_live_options();
  live.path = &path;
  live.rate_Hz = 250;
  PP_REQUIRE_OK(pp_session_record(ball.session, file.string().c_str()));
  PP_REQUIRE_OK(pp_live_start(ball.session, &live));
  const auto take = [&](std::uint64_t wanted) {
    std::uint64_t taken = 0;
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
         taken < wanted && std::chrono::steady_clock::now() < end;) {
      std::vector<pp_tick> ticks(256);
      std::uint64_t count = 0;
      PP_REQUIRE_OK(pp_live_read_ticks(ball.session, ticks.data(), ticks.size(), &count));
      taken += count;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  };
  take(100);
  // Another log ends the first one, and begins in contact.
  const auto later = folder.path() / "later.session";
  PP_REQUIRE_OK(pp_session_record(ball.session, later.string().c_str()));
  take(50);
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  for (const auto& each : {file, later}) {
    CAPTURE(each.string());
    const ReadLog log(each);
    CHECK(log.content.ended == 1);
    CHECK(log.content.ticks > 30);
    const pp_replay_result result = replay(each, ball.cloud.cloud);
    CHECK(result.ticks == log.content.ticks);
    CHECK(result.compared <= result.ticks);
    CHECK(result.force_ticks == 0);
    CHECK((result.compared == result.ticks) == std::string(result.reason).empty());
  }
}

TEST_CASE("sessions that cannot be recorded, and files that are not logs, are refused with an error") {
  const ScratchFolder folder;
  const auto file = folder.path() / "x.session";
  const std::string name = file.string();
  pp_session_options two = cpuOptions();
  two.hands = 2;
  {
    const OpenBall hands(two);
    PP_CHECK_FAILS(pp_session_record(hands.session, name.c_str()), PP_ERROR_STATE, "one hand");
    Calls calls;
    pp_session_options lawful = cpuOptions();
    lawful.law = ownLaw;
    lawful.law_user = &calls;
    const OpenBall law(lawful);
    PP_CHECK_FAILS(pp_session_record(law.session, name.c_str()), PP_ERROR_STATE, "law");
  }
  const OpenBall ball;
  CHECK(pp_session_record(ball.session, nullptr) == PP_ERROR_ARGUMENT);
  const auto press = pressPath(1);
  const pp_path path = pathOf(press);
  std::vector<pp_tick> ticks(200);
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_record(ball.session, (folder.path() / "no" / "folder").string().c_str()));
  CHECK(pp_session_touch(ball.session, &path, ticks.data(), ticks.size(), &count) == PP_ERROR_FILE);
  CHECK(touch(ball.session, path).size() == 200);  // only the first path after the request fails
  // A live session or a stroke that failed to start leaves no effect either.
  pp_live_options live = pp_default_live_options();
  live.path = &path;
  PP_REQUIRE_OK(pp_session_record(ball.session, (folder.path() / "no" / "folder").string().c_str()));
  CHECK(pp_live_start(ball.session, &live) == PP_ERROR_FILE);
  CHECK(pp_live_read_ticks(ball.session, ticks.data(), ticks.size(), &count) == PP_ERROR_STATE);
  const auto places = placesOf(ball.session);
  const pp_brush brush = pp_default_brush();
  PP_REQUIRE_OK(pp_session_record(ball.session, (folder.path() / "no" / "folder").string().c_str()));
  CHECK(pp_session_stroke(ball.session, &path, &brush, ticks.data(), ticks.size(), &count) == PP_ERROR_FILE);
  touch(ball.session, path);
  CHECK(placesOf(ball.session) == places);

  pp_recording log{};
  pp_replay_result result = pp_default_replay_result();
  CHECK(pp_recording_read(name.c_str(), &log) == PP_ERROR_FILE);
  std::ofstream(file) << "not a log";
  CHECK(pp_recording_read(name.c_str(), &log) == PP_ERROR_FILE);
  CHECK(pp_recording_replay(name.c_str(), nullptr, &result) == PP_ERROR_FILE);
  CHECK(pp_recording_replay(name.c_str(), nullptr, nullptr) == PP_ERROR_ARGUMENT);
  CHECK(log.id == 0);
  CHECK(pp_recording_close(log) == PP_ERROR_HANDLE);
  CHECK(pp_recording_close({ball.session.id}) == PP_ERROR_HANDLE);
  // Another program's file is not replaced.
  PP_REQUIRE_OK(pp_session_record(ball.session, name.c_str()));
  PP_CHECK_FAILS(pp_session_touch(ball.session, &path, ticks.data(), ticks.size(), &count), PP_ERROR_FILE,
                 "is not a session log");
  CHECK(contentOf(file) == "not a log");
  REQUIRE(std::filesystem::remove(file));
  PP_REQUIRE_OK(pp_session_record(ball.session, name.c_str()));
  touch(ball.session, path);
  const std::string whole = contentOf(file);
  // A truncated log is either read up to its end, or refused.
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += whole.size() / 37 + 1) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, bytes);
    pp_recording torn{};
    const pp_status status = pp_recording_read(name.c_str(), &torn);
    CHECK((status == PP_OK || status == PP_ERROR_FILE));
    if (status != PP_OK) continue;
    pp_recording_content content{};
    PP_REQUIRE_OK(pp_recording_view(torn, &content));
    CHECK(content.ended == 0);
    CHECK_FALSE(std::string(content.missing).empty());
    PP_REQUIRE_OK(pp_recording_close(torn));
  }
  std::ofstream(file, std::ios::binary) << whole;
  pp_replay_options options = pp_default_replay_options();
  options.cloud = ball.cloud.cloud;
  options.tolerance = -1;
  CHECK(pp_recording_replay(name.c_str(), &options, &result) == PP_ERROR_ARGUMENT);
  options.tolerance = 0;
  options.cloud = {ball.session.id};
  CHECK(pp_recording_replay(name.c_str(), &options, &result) == PP_ERROR_HANDLE);
}

}  // namespace palpate::logs_test
