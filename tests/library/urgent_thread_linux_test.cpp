// Calls of a real-time thread beside those of an ordinary one on the same core.
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "tests/labels.hpp"
#include "tests/library/ball.hpp"

namespace palpate::urgent_thread_test {

TEST_CASE("a real-time thread never waits for an ordinary one that uses the same handle" * kClock) {
  const BallCloud ball(100);
  std::atomic<bool> end = false;
  double slowest_s = 0;
  bool isUrgent = false;
  const auto onFirstCore = [] {
    cpu_set_t core;
    CPU_ZERO(&core);
    CPU_SET(0, &core);
    return pthread_setaffinity_np(pthread_self(), sizeof core, &core) == 0;
  };
  const auto look = [&] {
    pp_points points{};
    return pp_cloud_view(ball.cloud, &points) == PP_OK;
  };
  std::atomic<int> wrong = 0;
  std::thread ordinary([&] {
    onFirstCore();
    while (!end) wrong += !look();
  });
  std::thread urgent([&] {
    using Clock = std::chrono::steady_clock;
    const sched_param priority{.sched_priority = 50};
    isUrgent = onFirstCore() && pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
    for (int i = 0; isUrgent && i < 5'000; ++i) {
      std::this_thread::sleep_for(std::chrono::microseconds(20 + i % 7));
      const auto before = Clock::now();
      wrong += !look();
      slowest_s = std::max(slowest_s, std::chrono::duration<double>(Clock::now() - before).count());
    }
  });
  urgent.join();
  end = true;
  ordinary.join();
  CHECK(wrong == 0);
  if (!isUrgent) {
    MESSAGE("skipped: real-time priority is not permitted here");
    return;
  }
  CHECK(slowest_s < 0.3);
}

}  // namespace palpate::urgent_thread_test
