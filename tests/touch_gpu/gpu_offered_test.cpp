// Changes that others offer to a back end, on the GPU.
#include <atomic>
#include <thread>

#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/offering.hpp"

namespace palpate::gpu_offered_test {

namespace {

constexpr BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8, .resample = false};

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "an offer of very many points rebuilds the index instead of updating it") {
  const Scene scene = makeScene("sphere", 3'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = kPush});
  Offering others(touch, scene.cloud, 5);
  double time_s = 0;
  const auto rest = [&] {
    touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 200}}, 0);
    others.follow();
  };
  // The largest offer, all at one position: its bucket outgrows the reserve.
  const std::size_t most = std::min<std::size_t>(touch.edits()->mostOffered(), 2'000);
  for (const Vec3 place : {Vec3(0, 0, 0), Vec3(3, -40, 11), Vec3(0, 0, 0)}) {
    std::vector<PointChange> heap;
    for (const PointState& point : others.shown().first(most)) {
      heap.push_back({point, point});
      heap.back().to.position = place + Vec3(1e-3F * static_cast<float>(point.number % 7), 0, 0);
    }
    REQUIRE(others.offerThese(heap));
    rest();
    rest();
    CHECK(others.lastTaken() == most);
  }
  touch.finish();
  others.checkEnd();
  CHECK(others.reports() == 3);
}

TEST_CASE_FIXTURE(GpuFixture, "on the GPU offers from another thread are carried out in real time") {
  const Scene scene = makeScene("sphere", 20'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = kPush});
  Offering others(touch, scene.cloud, 9);
  std::atomic<std::size_t> taken = 0;
  {
    std::jthread follower([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        others.follow();
        taken = others.taken();
        others.offer(50, 1, [](const PointState& point) { return point.position.z < 0; });
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    // The budget suits a software driver.
    for (int i = 0; i < 300 || taken < 200 || !touch.report().firstEdit_s; ++i) {
      REQUIRE(i < 20'000);
      const double time_s = 1e-2 * i;
      touch.query({.time_s = time_s, .hip = {0, 0, 51 - 0.01 * (i % 200)}}, 10'000);
    }
  }
  touch.query({.time_s = 1e3, .hip = {0, 0, 200}}, 0);
  touch.query({.time_s = 1e3, .hip = {0, 0, 200}}, 0);
  touch.finish();
  others.checkEnd();
  CHECK(others.offers() - others.reports() <= 1);
  CHECK(others.history().counts().strokes > 0);
}

}  // namespace palpate::gpu_offered_test
