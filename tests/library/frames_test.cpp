// A cloud whose frames a program supplies: its position at each time is felt, by path, tick by tick and live.
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"
#include "tests/png_bytes.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::frames_test {

namespace {

constexpr std::size_t kPoints = 5'000;
// The averaged surface is this far below the ball (0.0694 r^2 / R, engine/contact).
constexpr double kSunk_mm = 0.145;

struct MovingBall {
  BallCloud cloud{kPoints};
  pp_session session{};
  explicit MovingBall(const pp_frames_options& frames = pp_default_frames_options(),
                      const pp_session_options& options = cpuOptions()) {
    PP_REQUIRE_OK(pp_session_open_frames(cloud.cloud, &frames, &options, &session));
  }
  ~MovingBall() { pp_session_close(session); }
  MovingBall(const MovingBall&) = delete;
  MovingBall& operator=(const MovingBall&) = delete;

  pp_status push(double t_s, double height, double speed = 0, std::size_t points = kPoints) const {
    const BallArrays<float> ball(points, {0, 0, height});
    std::vector<float> velocities;
    for (std::size_t i = 0; i < points; ++i) velocities.insert(velocities.end(), {0, 0, static_cast<float>(speed)});
    pp_frame_arrays frame = pp_default_frame_arrays();
    frame.count = points;
    frame.t_s = t_s;
    frame.positions = ball.arrays().positions;
    frame.normals = ball.arrays().normals;
    if (speed != 0) frame.velocities = {velocities.data(), PP_FLOAT32, 0, 0};
    return pp_session_push_frame(session, &frame);
  }
};

// A hand that rests 1 mm above the ball's initial position.
std::vector<double> stand(std::size_t ticks) {
  std::vector<double> rows;
  for (std::size_t i = 0; i < ticks; ++i) rows.insert(rows.end(), {0.3, -0.2, kBallRadius + 1});
  return rows;
}

/// Takes a live hand's ticks until `areEnough`, or until 30 s have passed.
std::vector<pp_tick> takeUntil(pp_session session, const std::function<bool(const std::vector<pp_tick>&)>& areEnough) {
  std::vector<pp_tick> all;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    std::vector<pp_tick> ticks(4096);
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_live_read_ticks(session, ticks.data(), ticks.size(), &count));
    all.insert(all.end(), ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(count));
    if (areEnough(all)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return all;
}

}  // namespace

TEST_CASE("a frame is felt from its time on, and time continues from path to path") {
  const MovingBall ball;
  PP_REQUIRE_OK(ball.push(0.05, 1.5));
  PP_REQUIRE_OK(ball.push(0.15, 2.5));
  const auto rows = stand(100);
  const auto first = touch(ball.session, pathOf(rows));
  CHECK(first[49].contact == 0);
  CHECK(first[52].contact == 1);
  CHECK(first.back().penetration_mm == within(0.5 - kSunk_mm, 0.01));
  const auto second = touch(ball.session, pathOf(rows));
  CHECK(second.front().t_s == near(0.1, 1e-6));
  CHECK(second[40].penetration_mm == within(0.5 - kSunk_mm, 0.01));
  CHECK(second.back().penetration_mm == within(1.5 - kSunk_mm, 0.01));
  pp_frame frame{};
  PP_REQUIRE_OK(pp_session_frame(ball.session, &frame));
  pp_moving_points points{};
  PP_REQUIRE_OK(pp_frame_view(frame, &points));
  CHECK(points.points.count == kPoints);
  CHECK(points.points.max[2] == near(kBallRadius + 2.5, 1e-3));
  CHECK(points.t_s == 0.15);
  PP_REQUIRE_OK(pp_frame_close(frame));
  CHECK(placesOf(ball.session).size() == 3 * kPoints);
}

TEST_CASE("velocities extrapolate points between frames, up to a time limit") {
  const MovingBall still, carried;
  PP_REQUIRE_OK(still.push(0.01, 1.2));
  PP_REQUIRE_OK(carried.push(0.01, 1.2, 20));
  const auto rows = stand(200);
  const auto a = touch(still.session, pathOf(rows)), b = touch(carried.session, pathOf(rows));
  CHECK(a[40].penetration_mm == near(a[190].penetration_mm, 1e-3));
  CHECK(b[40].penetration_mm == within(a[40].penetration_mm + 20 * 0.03, 0.03));
  CHECK(b[190].penetration_mm == within(a[190].penetration_mm + 20 * 0.05, 0.03));
}

TEST_CASE("frames of other sizes are felt exactly, and those of doubles far from zero keep their positions") {
  pp_frames_options frames = pp_default_frames_options();
  frames.max_points = 2 * kPoints;
  const MovingBall ball(frames);
  PP_REQUIRE_OK(ball.push(0.02, 1.5, 0, 2 * kPoints));
  PP_REQUIRE_OK(ball.push(0.05, 2, 0, kPoints / 2));
  const auto rows = stand(90);
  const auto ticks = touch(ball.session, pathOf(rows));
  CHECK(ticks[40].penetration_mm == within(0.5 - kSunk_mm, 0.01));
  CHECK(ticks[80].penetration_mm == within(1 - kSunk_mm, 0.02));
  CHECK(ball.push(0.2, 2, 0, 2 * kPoints + 1) == PP_ERROR_ARGUMENT);
  const BallArrays<double> far(kPoints, {5e6, 4e6, 0}), higher(kPoints, {5e6, 4e6, 1.5});
  const pp_cloud_arrays arrays = far.arrays();
  pp_cloud cloud{};
  pp_session session{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  const pp_session_options options = cpuOptions();
  PP_REQUIRE_OK(pp_session_open_frames(cloud, nullptr, &options, &session));
  pp_frame_arrays frame = pp_default_frame_arrays();
  frame.count = kPoints;
  frame.t_s = 0.01;
  frame.positions = higher.arrays().positions;
  frame.normals = higher.arrays().normals;
  PP_REQUIRE_OK(pp_session_push_frame(session, &frame));
  std::vector<double> there;
  for (int i = 0; i < 40; ++i) there.insert(there.end(), {5e6 + 0.3, 4e6 - 0.2, kBallRadius + 1});
  CHECK(touch(session, pathOf(there)).back().penetration_mm == within(0.5 - kSunk_mm, 0.01));
  PP_REQUIRE_OK(pp_session_close(session));
  PP_REQUIRE_OK(pp_cloud_close(cloud));
}

TEST_CASE("frames are pushed by one thread while another touches, also live") {
  const MovingBall ball;
  const std::vector<double> rows{0, 0.3, -0.2, kBallRadius + 1};
  const pp_path path = pathOf(rows, 4);
  pp_live_options live = pp_default_live_options();
  live.path = &path;
  live.rate_Hz = 500;
  PP_REQUIRE_OK(ball.push(3, -5));  // an earlier frame: time restarts at 0 with it
  PP_REQUIRE_OK(pp_live_start(ball.session, &live));
  std::atomic<int> wrong = 0;
  std::thread camera([&] {
    for (int k = 1; k <= 25; ++k) {
      wrong += ball.push(0.02 * k, -5 + 0.3 * k) != PP_OK;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  camera.join();
  const auto ticks = takeUntil(ball.session, [](const std::vector<pp_tick>& all) {
    return all.size() > 100 && all.back().contact == 1 && std::abs(all.back().penetration_mm - (1.5 - kSunk_mm)) < 0.02;
  });
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  CHECK(wrong == 0);
  REQUIRE(ticks.size() > 100);
  for (const pp_tick& tick : ticks)
    if (tick.t_s < 0.2) CHECK(tick.contact == 0);  // no tick feels a frame before its time
  CHECK(ticks.back().contact == 1);
  CHECK(ticks.back().penetration_mm == within(1.5 - kSunk_mm, 0.02));
  // The next path begins at time 0, and so do its frames: the newest one applies until the next one's time.
  PP_REQUIRE_OK(ball.push(0.08, -5));
  std::vector<double> down = stand(120);
  for (std::size_t i = 0; i < 40; ++i) down[3 * i + 2] += 0.1 * static_cast<double>(40 - i);
  const auto after = touch(ball.session, pathOf(down));
  CHECK(after.front().t_s < 0.01);
  CHECK(after[5].contact == 0);
  CHECK(after[70].contact == 1);
  CHECK(after[70].penetration_mm == within(1.5 - kSunk_mm, 0.02));
  CHECK(after.back().contact == 0);
}

TEST_CASE("a recorded depth camera is felt frame by frame, restarts for a live session, and gives its points") {
  // A wall half a metre away comes a millimetre nearer with each frame, a hundred frames a second.
  constexpr std::uint32_t kWidth = 40, kHeight = 30, kFrames = 10;
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "depth");
  for (std::uint32_t i = 0; i < kFrames; ++i)
    writeBytes(folder / "depth" / ("000" + std::to_string(i) + ".png"),
               greyPng(kWidth, kHeight,
                       std::vector<std::uint16_t>(kWidth * kHeight, static_cast<std::uint16_t>(25'000 - 50 * i))));
  writeBytes(folder / "intrinsics.json", R"({"width": 40, "height": 30, "fx": 100, "fy": 100, "cx": 19.5, "cy": 14.5,
                                             "depth_scale": 50000, "fps": 100})");
  const std::string name = folder.path().string();
  pp_session session{};
  pp_session_options options = cpuOptions();
  options.mm_per_unit = 1000;
  PP_REQUIRE_OK(pp_session_open_stream(name.c_str(), nullptr, &options, &session));
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(session, &info));
  CHECK(info.points == kWidth * kHeight);
  CHECK(info.mm_per_unit == 1000);
  // A hand 2.5 mm in front of the wall.
  std::vector<double> rows;
  for (int i = 0; i < 120; ++i) rows.insert(rows.end(), {0, 0, 0.4975});
  const auto ticks = touch(session, pathOf(rows));
  CHECK(ticks[15].contact == 0);
  CHECK(ticks[60].contact == 1);
  CHECK(ticks[119].penetration_mm > ticks[60].penetration_mm + 1);
  CHECK(ticks[119].penetration_mm < 9);
  pp_frame frame{};
  PP_REQUIRE_OK(pp_session_frame(session, &frame));
  pp_moving_points points{};
  PP_REQUIRE_OK(pp_frame_view(frame, &points));
  CHECK(points.points.max[2] > 0.4905);  // from the last frames
  CHECK(points.points.max[2] < 0.4925);
  PP_REQUIRE_OK(pp_frame_close(frame));
  // A live session restarts with the first frame.
  const std::vector<double> stay{0, 0, 0, 0.4975};
  const pp_path path = pathOf(stay, 4);
  pp_live_options live = pp_default_live_options();
  live.path = &path;
  live.rate_Hz = 500;
  PP_REQUIRE_OK(pp_live_start(session, &live));
  const auto felt =
      takeUntil(session, [](const std::vector<pp_tick>& all) { return all.size() > 50 && all.back().contact == 1; });
  PP_REQUIRE_OK(pp_live_stop(session));
  REQUIRE(felt.size() > 50);
  CHECK(felt.back().contact == 1);
  pp_brush brush = pp_default_brush();
  CHECK(pp_session_set_brush(session, &brush) == PP_ERROR_ARGUMENT);
  pp_frame_arrays pushed = pp_default_frame_arrays();
  CHECK(pp_session_push_frame(session, &pushed) != PP_OK);
  PP_REQUIRE_OK(pp_session_close(session));
  pp_stream_options stream = pp_default_stream_options();
  stream.speed = -1;
  PP_CHECK_FAILS(pp_session_open_stream(name.c_str(), &stream, &options, &session), PP_ERROR_ARGUMENT, "speed");
  stream.speed = 1;
  stream.intrinsics = "/nowhere.json";
  CHECK(pp_session_open_stream(name.c_str(), &stream, &options, &session) == PP_ERROR_FILE);
  CHECK(pp_session_open_stream("/nowhere", nullptr, &options, &session) == PP_ERROR_FILE);
  CHECK(pp_session_open_stream(nullptr, nullptr, &options, &session) == PP_ERROR_ARGUMENT);
}

TEST_CASE("while nothing touches, frames are accepted without end, and the newest are felt") {
  const MovingBall ball;
  for (int k = 1; k <= 1100; ++k) PP_REQUIRE_OK(ball.push(1e-4 * k, -5, 0, 100));
  PP_REQUIRE_OK(ball.push(0.15, 0));
  PP_REQUIRE_OK(ball.push(0.2, 1.5));
  const auto rows = stand(300);
  const std::vector<pp_tick> ticks = touch(ball.session, pathOf(rows));
  CHECK(ticks[190].contact == 0);
  CHECK(ticks.back().penetration_mm == within(0.5 - kSunk_mm, 0.01));
}

TEST_CASE("invalid frames are refused, and the last valid one is still felt") {
  pp_frames_options kept = pp_default_frames_options();
  kept.stable_rows = 1;
  const MovingBall ball(kept);
  PP_REQUIRE_OK(ball.push(0.01, 1.5));
  PP_CHECK_FAILS(ball.push(0.01, 2), PP_ERROR_ARGUMENT, "after the frame before");
  CHECK(ball.push(std::nan(""), 2) == PP_ERROR_ARGUMENT);
  CHECK(ball.push(0.02, std::nan("")) == PP_ERROR_ARGUMENT);
  PP_CHECK_FAILS(ball.push(0.02, 1, 0, kPoints - 1), PP_ERROR_ARGUMENT, "stable_rows");
  pp_frame_arrays frame = pp_default_frame_arrays();
  CHECK(pp_session_push_frame(ball.session, &frame) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_push_frame(ball.session, nullptr) == PP_ERROR_ARGUMENT);
  const BallArrays<float> bare(kPoints);
  frame.count = kPoints;
  frame.t_s = 1;
  frame.positions = bare.arrays().positions;
  PP_CHECK_FAILS(pp_session_push_frame(ball.session, &frame), PP_ERROR_ARGUMENT, "normals");
  const std::vector<float> zeros(3 * kPoints, 0);
  frame.normals = {zeros.data(), PP_FLOAT32, 0, 0};
  PP_CHECK_FAILS(pp_session_push_frame(ball.session, &frame), PP_ERROR_ARGUMENT, "normals: are zero");
  frame.normals = bare.arrays().normals;
  std::vector<float> velocities(3 * kPoints, 1);
  velocities[7] = INFINITY;
  frame.velocities = {velocities.data(), PP_FLOAT32, 0, 0};
  PP_CHECK_FAILS(pp_session_push_frame(ball.session, &frame), PP_ERROR_ARGUMENT, "velocities");
  frame.velocities.type = PP_UINT8;
  CHECK(pp_session_push_frame(ball.session, &frame) == PP_ERROR_ARGUMENT);
  pp_brush brush = pp_default_brush();
  CHECK(pp_session_set_brush(ball.session, &brush) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_record(ball.session, "/tmp/never.session") == PP_ERROR_STATE);
  CHECK(pp_session_pause(ball.session, 1) == PP_ERROR_STATE);
  const auto rows = stand(50);
  CHECK(touch(ball.session, pathOf(rows)).back().penetration_mm == within(0.5 - kSunk_mm, 0.01));

  const OpenBall still;
  frame.velocities = {};
  CHECK(pp_session_push_frame(still.session, &frame) == PP_ERROR_STATE);
  CHECK(pp_session_push_frame({}, &frame) == PP_ERROR_HANDLE);
  pp_frames_options few = pp_default_frames_options();
  few.max_points = 3;
  pp_session session{};
  PP_CHECK_FAILS(pp_session_open_frames(ball.cloud.cloud, &few, nullptr, &session), PP_ERROR_ARGUMENT, "max_points");
}

}  // namespace palpate::frames_test
