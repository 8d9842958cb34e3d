// Sculpting until the index has been compacted, which must not be felt.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/touch/memory.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::background_compaction_test {

namespace {

constexpr double kVirtual = 0, kRealtime_us = 1e7;  // budgets; the latter is never exhausted
constexpr std::chrono::milliseconds kTick(1);       // minimum in real time
// Seconds between poses. A slow edit postpones the next one, and the delay doubles with each further slow edit: even a
// thousand in a row do not reach the next pose, so that the slowest machine makes all edits.
constexpr double kApart_s = 1e303;
constexpr std::uint32_t kLittleSpare = 1'200, kMinSpare = 320;

TouchOptions optionsFor(const Scene& scene, std::uint32_t spare) {
  return {.radius = scene.radius,
          .brush = BrushOptions{.yieldDepth = 0.2, .pushRate = 0.3, .radius = 7, .resample = false},
          .spareSlots = spare,
          .compaction = {.bucketsPerSlice = 512},
          .wait = Wait::block};
}

// Round the sphere repeatedly, ever deeper.
Pose strokeAt(int tick) {
  const double angle = 0.01 * tick, r = 51 - std::min(1.5, 0.05 * tick) - 0.004 * tick, tilt = 0.1 + 0.0005 * tick;
  return {.time_s = kApart_s * tick,
          .hip = {r * std::sin(tilt) * std::cos(angle), r * std::sin(tilt) * std::sin(angle), r * std::cos(tilt)}};
}

// Points that are missing, duplicate or not in their bucket.
std::size_t faults(Device& device, const TouchSide& touch) {
  const auto positions = download<Vec4>(device, touch.live().front().positions, touch.live().slots());
  const HashGrid& grid = touch.hash().grid();
  const auto ranges = download<UVec2>(device, touch.hash().ranges(touch.live().front()), grid.bucketMask + 1);
  std::size_t faults = 0;
  std::set<std::uint32_t> seen;
  for (std::uint32_t bucket = 0; bucket < ranges.size(); ++bucket)
    for (std::uint32_t slot = ranges[bucket].x; slot < ranges[bucket].y; ++slot)
      faults += bucketOf(grid, cellOf(grid, Vec3(positions.at(slot)))) != bucket ||
                !seen.insert(std::bit_cast<std::uint32_t>(positions[slot].w)).second;
  return faults + (touch.live().points().size() - seen.size());
}

struct Stroke {
  std::vector<Contact> contacts;
  PointCloud cloud;
  std::uint64_t compactions = 0, editsHeldUp = 0;
};

Stroke sculpt(Device& device, const Scene& scene, std::uint32_t spare, double budget_us, int ticks) {
  TouchSide touch(device, scene.cloud, optionsFor(scene, spare));
  const std::uint64_t bytes = device.allocatedBytes();
  Stroke stroke{.cloud = scene.cloud};
  const bool realtime = budget_us > 0;
  for (int tick = 0; tick < ticks; ++tick) {
    // The background work gets the time that it has in a session.
    const auto next = std::chrono::steady_clock::now() + kTick;
    stroke.contacts.push_back(touch.query(strokeAt(tick), budget_us));
    if (realtime) std::this_thread::sleep_until(next);
  }
  touch.finish();
  CHECK(device.allocatedBytes() == bytes);
  CHECK(touch.report().shortfalls.editsRebuilt == 0);
  CHECK(touch.report().shortfalls.editsTooSlow == 0);
  CHECK(touch.report().editTimes_us.size() > static_cast<std::size_t>(ticks) / 3);
  CHECK(faults(device, touch) == 0);
  touch.readBack(stroke.cloud);
  stroke.compactions = touch.report().compactions;
  stroke.editsHeldUp = touch.report().shortfalls.editsHeldUp;
  CHECK((touch.report().costs.longestCompactionEnd_us > 0) == (stroke.compactions > 0));
  if (stroke.compactions > 0)
    MESSAGE(stroke.compactions << " compactions, the longest end " << touch.report().costs.longestCompactionEnd_us
                               << " us");
  return stroke;
}

void checkEqual(const Stroke& a, const Stroke& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.contacts.size(); ++i)
    different += a.contacts[i].proxy != b.contacts[i].proxy || a.contacts[i].neighbours != b.contacts[i].neighbours ||
                 !a.contacts[i].valid || !b.contacts[i].valid;
  CHECK(different == 0);
  CHECK(a.cloud.positions == b.cloud.positions);
  CHECK(a.cloud.normals == b.cloud.normals);
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "in virtual time a stroke with background compactions gives the same result bit by bit") {
  const Scene scene = makeScene("sphere", 20'000);
  const int ticks = 400;
  const Stroke without = sculpt(device, scene, 1 << 17, kVirtual, ticks);
  CHECK(without.compactions == 0);
  const Stroke with = sculpt(device, scene, kMinSpare, kVirtual, ticks);
  CHECK(with.compactions >= 2);
  checkEqual(with, without);
}

TEST_CASE("in real time background compactions change no contact, and no edit requires a build" * kFull) {
  Device device({.gpu = "", .validation = Validation::off});
  const Scene scene = makeScene("sphere", 20'000);
  const Stroke without = sculpt(device, scene, 1 << 17, kVirtual, 1'000);
  const Stroke with = sculpt(device, scene, kLittleSpare, kRealtime_us, 1'000);
  CHECK(with.compactions >= 3);
  CHECK(with.editsHeldUp == 0);
  checkEqual(with, without);
}

TEST_CASE("in real time edits without free slots wait for a compaction, not for a build" * kMoreInFull) {
  Device device({.gpu = "", .validation = Validation::off});
  const Scene scene = makeScene("sphere", 20'000);
  const Stroke stroke = sculpt(device, scene, kMinSpare, kRealtime_us, 1'000);
  CHECK(stroke.compactions >= 3);
  CHECK(stroke.editsHeldUp > 0);
}

TEST_CASE_FIXTURE(GpuFixture, "an index rebuild, by a change or an edit, replaces a compaction") {
  // Few spare slots, so that one compaction follows another, and many points in one spot, so that an edit there is
  // large.
  Scene scene = makeScene("sphere", 8'000);
  for (int i = 0; i < 2'000; ++i) {
    const double angle = 2.4 * i, tilt = 0.1 * std::sqrt(i / 2'000.0);
    const Vec3 normal(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), -std::cos(tilt));
    scene.cloud.positions.push_back(50.0f * normal);
    scene.cloud.normals.push_back(normal);
  }
  TouchOptions options = optionsFor(scene, 600);
  options.compaction.bucketsPerSlice = 256;  // slow enough for the hand to get there
  TouchSide touch(device, scene.cloud, options);
  int tick = 0;
  const auto play = [&](const Pose& pose) { CHECK(touch.query(pose, kRealtime_us).valid); };
  const auto sculptUntil = [&](auto&& done) {
    while (tick < 3'000 && !done()) play(strokeAt(tick++));
    REQUIRE(done());
  };
  sculptUntil([&] { return touch.report().compactions > 0 && touch.report().isCompacting; });

  // One bucket receives more points than an update sorts.
  std::vector<PointChange> changes;
  touch.finish();
  for (const PointState& point : touch.live().points()) {
    if (changes.size() == 600) break;
    PointState to = point;
    to.position = Vec3(60, 60, 60);
    changes.push_back({point, to});
  }
  CHECK(touch.report().isCompacting);
  touch.edits()->change(changes);
  CHECK_FALSE(touch.report().isCompacting);
  CHECK(faults(device, touch) == 0);

  sculptUntil([&] { return touch.report().isCompacting; });
  const std::uint64_t before = touch.report().compactions;
  bool givenUp = false;
  touch.resetHand(0);
  for (int i = 0; i < 40 && touch.report().compactions == before && !givenUp; ++i) {
    play({.time_s = kApart_s * tick++, .hip = {0, 0, -50.6 + 0.2 * i}});
    givenUp = !touch.report().isCompacting && touch.report().compactions == before;
  }
  CHECK(givenUp);
  touch.finish();
  CHECK(faults(device, touch) == 0);
  const std::uint64_t then = touch.report().compactions;
  sculptUntil([&] { return touch.report().compactions > then; });
  touch.finish();
  CHECK(faults(device, touch) == 0);
}

TEST_CASE("the predicted memory of a live cloud with an editable index is little more than twice that without") {
  for (const std::uint64_t points : {1'000'000ull, 10'000'000ull, 100'000'000ull}) {
    CAPTURE(points);
    const GpuMemory memory = predictGpuMemory(points, false);
    const double without = static_cast<double>(memory.liveCloud + memory.index);
    const double ratio = (without + static_cast<double>(memory.editing)) / without;
    MESSAGE(ratio);
    CHECK(ratio < 2.12);
  }
}

}  // namespace palpate::background_compaction_test
