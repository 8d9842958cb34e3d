// Long calls observed by the program: they end soon when it asks for it, and their partial results are consistent.
#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include "tests/library/ball.hpp"
#include "tests/library/simulating.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::watch_test {

namespace {

/// Requests a stop at the `stopAt`-th query, and as soon as the share `stopAtShare` is done.
struct Watcher {
  int stopAt = 1'000'000;
  double stopAtShare = 2;
  int asked = 0, told = 0;
  double share = -1;
  bool isOtherThread = false, hasStopped = false;
  std::thread::id thread = std::this_thread::get_id();
  std::chrono::steady_clock::time_point stopped;

  pp_watch watch() {
    return {.stop =
                [](void* user) {
                  auto& self = *static_cast<Watcher*>(user);
                  self.isOtherThread = self.isOtherThread || std::this_thread::get_id() != self.thread;
                  if (++self.asked < self.stopAt && self.share < self.stopAtShare) return 0;
                  if (!std::exchange(self.hasStopped, true)) self.stopped = std::chrono::steady_clock::now();
                  return 1;
                },
            .progress =
                [](void* user, const char* what, double done) {
                  auto& self = *static_cast<Watcher*>(user);
                  self.told += what[0] != 0 && done >= self.share;
                  self.share = done;
                },
            .user = this};
  }
  double sinceStopped_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - stopped).count();
  }
};

constexpr double kSoon_s = 2;  // on a busy machine; 0.2 s on an idle one

void checkStopped(pp_status status, const Watcher& watcher) {
  CHECK_MESSAGE(status == PP_ERROR_STOPPED, std::string(pp_last_error()));
  CHECK(watcher.sinceStopped_s() < kSoon_s);
  CHECK_FALSE(watcher.isOtherThread);
}

}  // namespace

TEST_CASE("a stopped path gives the ticks done so far, and a stopped stroke can be undone") {
  Watcher watcher;
  pp_session_options options = cpuOptions();
  options.watch = watcher.watch();
  const OpenBall ball(options, 5'000);
  const auto before = placesOf(ball.session);
  const auto path = pressPath(4, 100, 200'000);
  const pp_path given = pathOf(path);
  std::vector<pp_tick> ticks(path.size() / 3);
  std::uint64_t count = 7;
  watcher = {.stopAtShare = 0.05};
  checkStopped(pp_session_touch(ball.session, &given, ticks.data(), ticks.size(), &count), watcher);
  CHECK(count > 0);
  CHECK(count < ticks.size());
  CHECK(ticks[count - 1].hip[2] == path[3 * count - 1]);
  CHECK(watcher.told > 0);
  CHECK(watcher.share == within(static_cast<double>(count) / static_cast<double>(ticks.size()), 0.2));
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  watcher = {.stopAtShare = 0.0015};  // 300 ticks
  checkStopped(pp_session_stroke(ball.session, &given, &brush, ticks.data(), ticks.size(), &count), watcher);
  REQUIRE(count > 100);
  CHECK(placesOf(ball.session) != before);
  watcher = {};
  std::uint64_t undone = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &undone));
  CHECK(undone == 1);
  CHECK(placesOf(ball.session) == before);
  CHECK(touch(ball.session, pathOf(pressPath(1))).back().force_N[2] > 0.5);
}

TEST_CASE("opening, reading or writing that is stopped gives no handle and leaves no file") {
  const ScratchFolder folder;
  const BallArrays<float> arrays(200'000);
  pp_cloud_arrays bare = arrays.arrays();
  bare.normals = {};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&bare, &cloud));
  Watcher watcher{.stopAt = 1};
  pp_session_options options = cpuOptions();
  options.watch = watcher.watch();
  pp_session session{7};
  checkStopped(pp_session_open(cloud, &options, &session), watcher);
  CHECK(session.id == 0);
  const std::string file = (folder.path() / "ball.xyz").string();
  watcher = {.stopAt = 1};
  pp_write_options write = pp_default_write_options();
  write.watch = watcher.watch();
  checkStopped(pp_cloud_write(cloud, file.c_str(), &write), watcher);
  CHECK(std::filesystem::is_empty(folder.path()));
  watcher = {};
  PP_REQUIRE_OK(pp_cloud_write(cloud, file.c_str(), &write));
  watcher = {.stopAt = 1};
  pp_read_options read = pp_default_read_options();
  read.watch = watcher.watch();
  pp_cloud again{7};
  checkStopped(pp_cloud_read(file.c_str(), &read, &again), watcher);
  CHECK(again.id == 0);
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("setting the first brush can be stopped, and the session stays usable and accepts it later") {
  Watcher watcher;
  pp_session_options options = cpuOptions();
  options.watch = watcher.watch();
  const OpenBall ball(options, 60'000);
  const pp_brush brush = pp_default_brush();
  watcher = {.stopAt = 1};
  checkStopped(pp_session_set_brush(ball.session, &brush), watcher);
  watcher = {};
  CHECK(touch(ball.session, pathOf(pressPath(1, 50, 10))).back().force_N[2] > 0.3);
  PP_CHECK_OK(pp_session_set_brush(ball.session, &brush));
}

TEST_CASE("matter that is stopped keeps the state after its last step, and continues from there") {
  if (!canSimulate()) return;
  Watcher watcher;
  pp_matter_options options = pp_default_matter_options();
  options.gpu = "cpu";
  options.watch = watcher.watch();
  pp_matter dam{};
  PP_REQUIRE_OK(pp_matter_open("dam", &options, &dam));
  watcher = {.stopAt = 5};
  checkStopped(pp_matter_step(dam, 1'000'000), watcher);
  pp_matter_state state = pp_default_matter_state();
  PP_REQUIRE_OK(pp_matter_get_state(dam, &state));
  CHECK(state.t_s > 0);
  const double before_s = state.t_s;
  watcher = {};
  PP_REQUIRE_OK(pp_matter_step(dam, 1));
  PP_REQUIRE_OK(pp_matter_get_state(dam, &state));
  CHECK(state.t_s == within(before_s + 1e-3, 1e-9));
  PP_CHECK_OK(pp_matter_close(dam));
}

}  // namespace palpate::watch_test
