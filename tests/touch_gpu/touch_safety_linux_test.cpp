// GPU faults during touch, through the real query, the real loop and a simulated device.
#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "engine/gpu/transfer.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::touch_safety_test {

namespace {

/// A simulated Touch that records the last written force. The hand waits while forces ramp up, moves 2 mm in, comes out
/// briefly from 1.25 s on, and moves in again.
class WatchedTouch final : public HapticDevice {
 public:
  WatchedTouch() : touch_(press(), map(), {.lead_s = 0.6}) {}
  static Path press() {
    return Path({{0, {0, 0, 53}},
                 {0.2, {0, 0, 48}},
                 {0.65, {0, 0, 48}},
                 {0.7, {0, 0, 52}},
                 {0.8, {0, 0, 48}},
                 {3, {0, 0, 48}}});
  }
  static WorkspaceMap map() { return workspaceAround(press(), {}); }

  std::string_view name() const override { return touch_.name(); }
  DeviceLimits limits() const override { return touch_.limits(); }
  DeviceState read(double time_s) noexcept override { return touch_.read(time_s); }
  bool write(const DVec3& force_N) noexcept override {
    last_N = force_N;
    return touch_.write(force_N);
  }
  void emergencyStop() noexcept override { touch_.emergencyStop(); }
  bool isStopped() const noexcept override { return touch_.isStopped(); }
  void resume() noexcept override { touch_.resume(); }
  std::string faultText() const override { return touch_.faultText(); }

  DVec3 last_N{9};

 private:
  SimulatedTouch touch_;
};

/// Queries the touch side, and calls `before` ahead of each query.
class Meddled final : public OneHandQuery {
 public:
  Meddled(TouchSide& touch, std::function<void(double time_s)> before) : touch_(touch), before_(std::move(before)) {}
  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    before_(pose.time_s);
    return touch_.ask({&pose, 1}, budget_us).front();
  }
  void endTick() noexcept override { touch_.endTick(); }

 private:
  TouchSide& touch_;
  std::function<void(double time_s)> before_;
};

bool isTick(double time_s, double wanted_s) { return std::abs(time_s - wanted_s) < 5e-4; }

ServoResult played(HapticDevice& device, ContactQuery& query, double duration_s, bool realtime = false) {
  ServoLoop loop(device, query, ForceLaw({}, {}), {.duration_s = duration_s, .realtime = realtime},
                 {.map = WatchedTouch::map()});
  return loop.run();
}

/// Where the GPU is lost, and whether the hand sculpts.
struct Loss {
  bool atSubmit, sculpting;
};

void checkLostInMidTouch(bool realtime, const std::vector<Loss>& losses) {
  const Scene scene = makeScene("sphere", 20'000);
  for (const auto& [atSubmit, sculpting] : losses) {
    CAPTURE(atSubmit);
    CAPTURE(sculpting);
    const LostGpuLayer layer;
    Device device({.gpu = "", .validation = Validation::off});
    const auto takeGpu = LostGpuLayer::takeGpu();
    std::optional<BrushOptions> brush;
    if (sculpting) brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 6};
    TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = brush});
    constexpr double kLost_s = 1;
    bool lost = false;
    Meddled query(touch, [&](double time_s) {
      if (lost || time_s < kLost_s) return;
      takeGpu(atSubmit);
      lost = true;
    });
    WatchedTouch hand;
    const ServoResult result = played(hand, query, 3, realtime);
    const auto& rows = result.trace().rows;
    REQUIRE(lost);
    CHECK(hand.last_N == DVec3(0));
    REQUIRE(rows.size() > (realtime ? 50 : 500));
    CHECK(rows.back().force_N == DVec3(0));
    CHECK_FALSE(rows.back().valid);
    // Work in flight may have been answered before the driver is called again; in real time the patch may answer the
    // ticks until then.
    const auto after = std::ranges::count_if(rows, [](const TraceRow& row) { return row.time_s >= kLost_s; });
    CHECK(after <= (realtime ? 250 : 2));
    double peak_N = 0;
    for (const TraceRow& row : rows) peak_N = std::max(peak_N, glm::length(row.force_N));
    CHECK(peak_N > 0.2);
    CHECK_THROWS_WITH_AS(touch.finish(), doctest::Contains("the GPU stopped"), DeviceLost);
  }
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture,
                  "values from the shader that are not finite give zero force at their ticks, then a ramp") {
  const Scene scene = makeScene("sphere", 20'000);
  constexpr double kFrom_s = 1.2, kTo_s = 1.25;
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  const Buffer& normals = touch.live().front().normals;
  const auto good = download<Vec4>(device, normals, touch.live().slots());
  // Their sum is infinite, and an infinite vector has no direction: the shader's own arithmetic fails.
  const std::vector<Vec4> huge(good.size(), Vec4(3e38f, 3e38f, 3e38f, 0));
  Meddled query(touch, [&](double time_s) {
    if (isTick(time_s, kFrom_s)) upload(device, normals, huge);
    if (isTick(time_s, kTo_s)) upload(device, normals, good);
  });
  WatchedTouch hand;
  const ServoResult result = played(hand, query, 2.1);
  const auto& rows = result.trace().rows;
  REQUIRE(rows.size() == 2100);
  // Fraction of the spring's force that is felt.
  const auto share = [&](double time_s) {
    const TraceRow& row = rows[static_cast<std::size_t>(std::lround(time_s * 1000))];
    REQUIRE(row.contact);
    return glm::length(row.force_N) / (0.8 * row.penetration_mm);
  };
  CHECK(share(kFrom_s - 0.001) == near(1, 0.05));
  std::size_t wrong = 0;
  for (const TraceRow& row : rows) {
    const bool faulty = row.time_s > kFrom_s - 5e-4 && row.time_s < kTo_s - 5e-4;
    wrong += row.valid == faulty;
    if (faulty) REQUIRE(row.force_N == DVec3(0));
    REQUIRE(isFinite(row.force_N));
    REQUIRE(isFinite(row.proxy));
  }
  CHECK(result.counts().withheld.errors == 1);
  CHECK(summarize(result.trace()).faultTicks == 50);
  CHECK(wrong == 0);
  CHECK(share(1.42) < 0.5);  // the ramp takes half a second
  CHECK(share(1.42) > 0.1);
  CHECK(share(2) == near(1, 0.05));
}

TEST_CASE("losing the GPU during contact gives zero force from that tick on and ends the session with the reason" *
          kMoreInFull) {
  checkLostInMidTouch(
      false, byTier<std::vector<Loss>>({{false, true}}, {{false, false}, {false, true}, {true, false}, {true, true}}));
}

TEST_CASE("losing the GPU in real time gives zero force and ends the session once the patch has expired" *
          kMoreInFull) {
  checkLostInMidTouch(
      true, byTier<std::vector<Loss>>({{true, false}}, {{false, false}, {false, true}, {true, false}, {true, true}}));
}

TEST_CASE("the touch side can be destroyed after the GPU is lost during background compaction") {
  const Scene scene = makeScene("sphere", 20'000);
  for (const bool atSubmit : {false, true}) {
    CAPTURE(atSubmit);
    const LostGpuLayer layer;
    Device device({.gpu = "", .validation = Validation::off});
    const auto takeGpu = LostGpuLayer::takeGpu();
    const BrushOptions brush{.yieldDepth = 0.2, .pushRate = 0.3, .radius = 7, .resample = false};
    TouchSide touch(
        device, scene.cloud,
        {.radius = scene.radius, .brush = brush, .spareSlots = 500, .compaction = {.bucketsPerSlice = 256}});
    int tick = 0;
    const auto press = [&](double budget_us) {  // round the sphere, ever deeper and farther out
      const double angle = 0.01 * ++tick, tilt = 0.1 + 0.0005 * tick;
      const double r = 51 - std::min(1.5, 0.05 * tick) - 0.004 * tick;
      const DVec3 way(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
      constexpr double kApart_s = 1e303;  // even a thousand slow edits in a row do not postpone the next one
      return touch.query({.time_s = kApart_s * tick, .hip = r * way}, budget_us);
    };
    constexpr double kEver_us = 1e7, kSoon_us = 1e3;
    while (tick < 1000 && !touch.report().isCompacting) CHECK(press(kEver_us).valid);
    REQUIRE(touch.report().isCompacting);
    takeGpu(atSubmit);
    bool lost = false;
    while (tick < 2000 && !lost) lost = press(kSoon_us).lost;
    CHECK(lost);
    CHECK(touch.report().isCompacting);
  }
}

}  // namespace palpate::touch_safety_test
