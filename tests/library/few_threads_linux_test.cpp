// A session where the system starts only so many threads.
#include "tests/few_threads_linux.hpp"

#include <chrono>
#include <functional>
#include <limits>

#include "tests/library/ball.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::few_threads_test {

namespace {

constexpr const char* kNoThread = "the system does not start another thread";

struct Call {
  const char* name;
  std::function<pp_status()> call;
  bool needsThreads = false;  ///< it cannot do without, and is refused with kNoThread
};

/// Each call at every limit, until it works: in time, and with words or as if there was no limit.
void check(const std::vector<Call>& calls) {
  for (const auto& [name, call, needsThreads] : calls) {
    CAPTURE(std::string(name));
    pp_status status = PP_ERROR_FAILED;
    int refused = 0;
    for (int more = 0; status != PP_OK && more < 40; ++more) {
      CAPTURE(more);
      const auto since = std::chrono::steady_clock::now();
      {
        const FewThreads few(more);
        status = call();
      }
      CHECK(std::chrono::steady_clock::now() - since < std::chrono::seconds(10));
      if (status == PP_OK) continue;
      ++refused;
      CHECK_MESSAGE(lastErrorSays("thread"), std::string(pp_last_error()));
      if (needsThreads && more == 0) CHECK_MESSAGE(lastErrorSays(kNoThread), std::string(pp_last_error()));
    }
    CHECK(status == PP_OK);
    CHECK((refused > 0 || !needsThreads));
  }
}

}  // namespace

TEST_CASE("a session that cannot have its threads is refused in words, and does not hang") {
  if (!kThreadsCanBeFew) {
    MESSAGE("skipped: a sanitizer starts the threads");
    return;
  }
  const BallCloud ball;
  const pp_brush brush = pp_default_brush();
  pp_session_options options = cpuOptions();
  options.threads = 4;
  bool opens = false;
  int refused = 0;
  for (int more = 0; !opens && more < 100; ++more) {
    CAPTURE(more);
    pp_session session{};
    pp_status status = PP_OK;
    {
      const FewThreads few(more);
      status = pp_session_open(ball.cloud, &options, &session);
      if (status == PP_OK) status = pp_session_set_brush(session, &brush);
    }
    opens = status == PP_OK;
    if (!opens) {
      ++refused;
      CHECK(status == PP_ERROR_FAILED);
      CHECK_MESSAGE(lastErrorSays(kNoThread), std::string(pp_last_error()));
    }
    if (session.id != 0) PP_CHECK_OK(pp_session_close(session));
  }
  CHECK(opens);
  CHECK(refused >= 3);
}

TEST_CASE("an open session that gets no further thread refuses in words what needs one, and works afterwards") {
  if (!kThreadsCanBeFew) {
    MESSAGE("skipped: a sanitizer starts the threads");
    return;
  }
  const ScratchFolder folder;
  const std::string log = (folder / "log").string(), file = (folder / "ball.ply").string();
  const OpenBall ball;
  const std::vector<double> press = pressPath(1, 20, 5), asked{0, 0, 51, 0, 0, 70};
  const pp_path path = pathOf(press);
  const pp_rows positions{asked.data(), PP_FLOAT64, 0, 0};
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  std::vector<pp_tick> ticks(25);
  std::uint64_t count = 0;
  pp_surface_point found[2];
  const pp_contact_options contact = pp_default_contact_options();
  pp_read_options read = pp_default_read_options();
  read.watch.stop = [](void*) { return 0; };
  const pp_live_options live = [&] {
    pp_live_options options = pp_default_live_options();
    options.path = &path;
    return options;
  }();
  check({{"record",
          [&] {
            const pp_status begun = pp_session_record(ball.session, log.c_str());
            return begun == PP_OK ? pp_session_touch(ball.session, &path, ticks.data(), 25, &count) : begun;
          }},
         {"live", [&] { return pp_live_start(ball.session, &live); }, true}});
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  check({{"stroke", [&] { return pp_session_stroke(ball.session, &path, &brush, ticks.data(), 25, &count); }},
         {"nearest",
          [&] {
            return pp_session_nearest(ball.session, &positions, 2, std::numeric_limits<double>::infinity(), found);
          }},
         {"undo", [&] { return pp_session_undo(ball.session, 1, nullptr); }},
         {"live with a brush", [&] { return pp_live_start(ball.session, &live); }, true},
         {"a contact while it is live", [&] { return pp_session_set_contact(ball.session, &contact); }}});
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  check({{"write", [&] { return pp_cloud_write(ball.cloud.cloud, file.c_str(), nullptr); }},
         {"read",
          [&] {
            pp_cloud cloud{};
            const pp_status status = pp_cloud_read(file.c_str(), &read, &cloud);
            if (status == PP_OK) pp_cloud_close(cloud);
            return status;
          },
          true}});
  const std::vector<pp_tick> after = touch(ball.session, path);
  CHECK(after.back().contact == 1);
  CHECK(lengthOf(after.back().force_N) > 0.1);
}

TEST_CASE("more threads than any machine has are refused") {
  const BallCloud ball(100);
  pp_session_options options = cpuOptions();
  pp_session session{};
  for (const std::uint32_t threads : {1025u, 4'000'000'000u}) {
    options.threads = threads;
    PP_CHECK_FAILS(pp_session_open(ball.cloud, &options, &session), PP_ERROR_ARGUMENT, "is above the maximum, 1024");
  }
}

TEST_CASE("a struct whose size ends within a number is refused") {
  const BallCloud ball(100);
  pp_session_options options = cpuOptions();
  pp_session session{};
  for (const std::uint32_t size : {9u, 12u, 20u, static_cast<std::uint32_t>(sizeof options - 1)}) {
    options.size = size;
    PP_CHECK_FAILS(pp_session_open(ball.cloud, &options, &session), PP_ERROR_ARGUMENT, "its size is");
  }
}

}  // namespace palpate::few_threads_test
