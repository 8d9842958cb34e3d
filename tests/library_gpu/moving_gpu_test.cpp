// Moving clouds, several hands and session logs on a GPU.
#include <algorithm>

#include "tests/library/ball.hpp"
#include "tests/library/simulating.hpp"
#include "tests/library_gpu/gpu_options.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::moving_gpu_test {

TEST_CASE("on a GPU two hands touch the same water, and its frames show its motion") {
  if (!canSimulate()) return;
  pp_session_options options = gpuOptions();
  options.mm_per_unit = 0;
  options.hands = 2;
  pp_session water{};
  PP_REQUIRE_OK(pp_session_open_matter("drop", &options, &water));
  pp_frame frame{};
  pp_moving_points before{}, after{};
  PP_REQUIRE_OK(pp_session_frame(water, &frame));
  PP_REQUIRE_OK(pp_frame_view(frame, &before));
  std::vector<double> in, out;
  for (int i = 0; i < 15; ++i) {
    for (int k = 0; k < 3; ++k) in.push_back((before.points.min[k] + before.points.max[k]) / 2);
    out.insert(out.end(), {0, 1000, 0});
  }
  const pp_path one = pathOf(in), two = pathOf(out);
  const pp_path* const paths[]{&one, &two};
  std::vector<pp_tick> ticks(30);
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_touch_hands(water, paths, 2, nullptr, ticks.data(), nullptr, ticks.size(), &count));
  CHECK(count == 30);
  for (std::size_t i = 0; i < 30; ++i) CHECK(ticks[i].valid == 1);
  CHECK(lengthOf(ticks[29].force_N) == 0);  // far above
  pp_frame later{};
  PP_REQUIRE_OK(pp_session_frame(water, &later));
  PP_REQUIRE_OK(pp_frame_view(later, &after));
  CHECK(after.points.count == before.points.count);
  CHECK(after.t_s == near(0.014, 1e-6));
  CHECK_FALSE(
      std::equal(after.points.positions, after.points.positions + 3 * after.points.count, before.points.positions));
  PP_REQUIRE_OK(pp_frame_close(frame));
  PP_REQUIRE_OK(pp_frame_close(later));
  PP_REQUIRE_OK(pp_session_close(water));
}

TEST_CASE("replaying a recorded stroke on a GPU gives identical results") {
  const ScratchFolder folder;
  const std::string file = (folder / "dent.session").string();
  const OpenBall ball(gpuOptions(), 3'000);
  PP_REQUIRE_OK(pp_session_record(ball.session, file.c_str()));
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 10;
  const auto press = pressPath(4, 60, 20);
  stroke(ball.session, pathOf(press), brush);
  pp_replay_options options = pp_default_replay_options();
  options.cloud = ball.cloud.cloud;
  options.gpu = gpuOptions().gpu;
  pp_replay_result result = pp_default_replay_result();
  PP_REQUIRE_OK(pp_recording_replay(file.c_str(), &options, &result));
  CHECK(result.identical == 1);
  CHECK(result.compared == 80);
  CHECK(std::string(result.recorded_on) == std::string(result.machine));
}

TEST_CASE("on a GPU, frames pushed by the program are felt from their time on") {
  const BallCloud cloud(3'000);
  const BallArrays<float> higher(3'000, {0, 0, 1.5});
  const pp_session_options options = gpuOptions();
  pp_session session{};
  PP_REQUIRE_OK(pp_session_open_frames(cloud.cloud, nullptr, &options, &session));
  pp_frame_arrays frame = pp_default_frame_arrays();
  frame.count = 3'000;
  frame.t_s = 0.02;
  frame.positions = higher.arrays().positions;
  frame.normals = higher.arrays().normals;
  PP_REQUIRE_OK(pp_session_push_frame(session, &frame));
  std::vector<double> stand;
  for (int i = 0; i < 50; ++i) stand.insert(stand.end(), {0.3, -0.2, kBallRadius + 1});
  const auto ticks = touch(session, pathOf(stand));
  CHECK(ticks[15].contact == 0);
  CHECK(ticks[45].contact == 1);
  PP_REQUIRE_OK(pp_session_close(session));
}

}  // namespace palpate::moving_gpu_test
