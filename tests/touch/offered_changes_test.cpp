// Changes that others offer to the CPU, in real time too.
#include <atomic>
#include <thread>

#include "engine/touch/cpu_touch.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/offering.hpp"

namespace palpate::offered_changes_test {

namespace {

constexpr BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8, .resample = false};

}  // namespace

TEST_CASE("in real time a hand can sculpt although edits of others are offered before every answer") {
  const Scene scene = makeScene("sphere", 5'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = kPush});
  Offering others(touch, scene.cloud, 4);
  for (int i = 0; i < 60; ++i) {
    others.follow();
    if (!others.isOffered()) REQUIRE(others.offer(10, 1, [](const PointState& point) { return point.position.z < 0; }));
    // Far enough apart that no slow edit postpones the next one.
    touch.query({.time_s = 100.0 * i, .hip = {0, 0, std::max(48.0, 51 - 0.1 * i)}}, 60e6);
    PointCloud copy = scene.cloud;
    touch.readBack(copy);  // waits for the edit that the answer has started
  }
  touch.finish();
  others.checkEnd();
  CHECK(touch.report().editTimes_us.size() > 5);  // the brush's edits
  CHECK(others.reports() > 20);
}

TEST_CASE("edits on the CPU stop while their follower is too far behind, and resume once it has caught up") {
  const Scene scene = makeScene("sphere", 5'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = kPush, .editRoom = 500});
  EditStream& edits = *touch.edits();
  edits.keep();
  int tick = 0;
  const auto press = [&](int ticks) {
    for (int i = 0; i < ticks; ++i, ++tick) {
      touch.query({.time_s = 100.0 * tick, .hip = {0, 0, std::max(44.0, 51 - 0.05 * tick)}}, 60e6);
      PointCloud copy = scene.cloud;
      touch.readBack(copy);  // waits for the edit
    }
  };
  press(120);
  const auto dropped = [&] { return touch.report().shortfalls.editsLogFull; };
  REQUIRE(edits.room());
  CHECK(edits.room()->free == 0);
  CHECK(dropped() > 0);
  EditBatch batch;
  edits.take(batch);
  CHECK(batch.points.size() >= 500);
  CHECK(batch.points.size() < 2'000);  // the last edit went beyond
  const std::uint64_t before = dropped();
  press(2);
  CHECK(dropped() == before);
  const std::size_t taken = batch.points.size();
  edits.take(batch);
  CHECK(batch.points.size() > taken);
}

TEST_CASE("edits cannot be offered to a cloud without a brush, or with one that maintains density") {
  const Scene scene = makeScene("sphere", 500);
  CpuTouch still(scene.cloud, {.radius = scene.radius});
  CHECK(still.edits()->mostOffered() == 0);
  BrushOptions dense = kPush;
  dense.resample = true;
  CpuTouch kept(scene.cloud, {.radius = scene.radius, .brush = dense});
  CHECK(kept.edits()->mostOffered() == 0);
  CHECK_FALSE(kept.edits()->offer({}, 0));
}

TEST_CASE("edits of others are felt, in real time too, while another thread offers them") {
  const Scene scene = makeScene("sphere", 5'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = kPush});
  Offering others(touch, scene.cloud, 11);
  double time_s = 0;
  const auto ask = [&](double z, double budget_us) {
    return touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, z}}, budget_us);
  };
  constexpr int kOffers = 40;
  std::atomic<int> offers = 0;
  {
    std::jthread follower([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        others.follow();
        offers += others.offer(30, 1, [](const PointState& point) { return point.position.z < 0; });
      }
    });
    for (int i = 0; i < 400 || offers < kOffers; ++i) ask(51 - 0.01 * (i % 200), i % 4 ? 300 : 0);
  }
  ask(200, 0);
  touch.finish();
  others.checkEnd();
  CHECK(others.taken() > 100);
  CHECK(others.offers() - others.reports() <= 1);

  // The top is lowered by 10: a hand passes its old position and feels the new one.
  const auto feels = [&](double z) {
    for (const double above : {3, 1}) ask(z + above, 0);
    return ask(z - 0.2, 0).touching;
  };
  std::vector<PointChange> lower;
  for (const PointState& point : others.shown()) {
    if (point.gone || point.position.z < 40) continue;
    lower.push_back({point, point});
    lower.back().to.position.z -= 10;
  }
  const double top = std::ranges::max(others.shown(), {}, [](const PointState& p) { return p.position.z; }).position.z;
  if (others.isOffered()) ask(200, 0);
  others.follow();
  REQUIRE(others.offerThese(lower));
  ask(200, 0);
  CHECK_FALSE(feels(top - 1));
  CHECK(feels(top - 12));
}

}  // namespace palpate::offered_changes_test
