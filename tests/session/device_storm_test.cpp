// Random commands while a stylus presses, in real time: a simulated Touch, and fakes of two vendors' drivers.
// ctest: waits
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "haptics/devices/haply_device.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/devices/wrapped_device.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/labels.hpp"
#include "tests/session/command_storm.hpp"

namespace palpate::device_storm_test {

namespace {

constexpr double kStiffest_N_per_mm = 0.4;
constexpr double kStall_s = 0.04;  // the gate takes a longer pause of the ticks for an error

/// From outside down onto the sphere's pole, 2 mm deep, and there it stays.
const std::vector<PathKey> kPressing{{0, {0, 26, 0}}, {0.1, {0, 26, 0}}, {0.5, {0, 17, 0}}};

// Whether the plane of a late answer fades. That of a loan is whole for longer than a command may take here.
bool fades(const TraceRow& before, const TraceRow& row) {
  constexpr double kStep_mm = 0.02;
  return !before.fresh && !row.fresh && before.contact && glm::distance(before.hip, row.hip) < kStep_mm &&
         row.penetration_mm < before.penetration_mm - kStep_mm;
}

// Rows up to the first stall of the machine: of the ticks, or of an edit, whose thread was preempted.
std::vector<TraceRow> steady(std::vector<TraceRow> rows) {
  std::size_t end = rows.empty() ? 0 : 1;
  while (end < rows.size() && rows[end].time_s - rows[end - 1].time_s < kStall_s && !fades(rows[end - 1], rows[end]))
    ++end;
  rows.resize(end);
  return rows;
}

/// Largest change of the force in a tick beyond 60 N/s and what the hand's motion may do, N.
double excess_N(const std::vector<TraceRow>& rows, double from_s) {
  // Spring and damper, and the passivity controller's own.
  const double damping_N_s_per_mm = ForceOptions{}.damping_N_s_per_mm + DeviceLimits{}.mostDamping_N_s_per_mm;
  double most_N = -1;
  for (std::size_t i = 2; i < rows.size(); ++i) {
    if (rows[i].time_s < from_s) continue;
    const double dt_s = rows[i].time_s - rows[i - 1].time_s, before_s = rows[i - 1].time_s - rows[i - 2].time_s;
    const double way_mm = glm::distance(rows[i].hip, rows[i - 1].hip);
    const double speeds_mm_per_s = way_mm / dt_s + glm::distance(rows[i - 1].hip, rows[i - 2].hip) / before_s;
    const double hand_N = kStiffest_N_per_mm * way_mm + damping_N_s_per_mm * speeds_mm_per_s;
    const double change_N = glm::distance(rows[i].force_N, rows[i - 1].force_N);
    most_N = std::max(most_N, change_N - hand_N - 60 * dt_s);
  }
  return most_N;
}

/// Notes when the device takes its force away by itself, as where a service is silent for 20 ms.
class Watched final : public WrappedDevice {
 public:
  using WrappedDevice::WrappedDevice;
  DeviceState read(double time_s) noexcept override {
    const DeviceState state = WrappedDevice::read(time_s);
    if (!state.rendersForce && time_s > kSettled_s && time_s < forceless_s) forceless_s = time_s;
    return state;
  }

  static constexpr double kSettled_s = 0.5;
  std::atomic<double> forceless_s = 1e9;
};

// `open` begins the motion of the hand, which must not press before the session is there.
void checkStorm(const std::function<std::unique_ptr<HapticDevice>()>& open, const DVec3& offset) {
  const auto kind = backendKind();
  SessionConfig config = stormy(*kind, "sphere");
  config.force.stiffness_N_per_mm = kStiffest_N_per_mm;
  Session session(config, sphereModel(),
                  {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 26}, .paintable = true});
  session.setBrush(std::nullopt);
  Watched device(open());
  session.start({{.device = &device, .map = {.scale = 1, .offset = offset}}}, {});
  std::vector<TraceRow> rows;
  RandomCommands random(session, 11, kStiffest_N_per_mm);
  const double begin_s = 1.5, end_s = begin_s + byTier(3.0, 60.0);
  double judged_s = 1e9;
  for (const Stopwatch since; session.isLive() && since.elapsed_s() < end_s;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    session.catchUp();
    session.live()->take(rows);
    const Stopwatch command;
    if (since.elapsed_s() > begin_s) random.one();
    // The planes of a loan fade from then on, as they must.
    if (command.elapsed_s() > kStall_s && !rows.empty()) judged_s = std::min(judged_s, rows.back().time_s);
  }
  CHECK(session.isLive());
  session.stop();
  session.live()->take(rows);
  rows = steady(std::move(rows));
  judged_s = std::min(judged_s, device.forceless_s.load());
  std::erase_if(rows, [&](const TraceRow& row) { return row.time_s >= judged_s; });
  if (rows.empty() || rows.back().time_s < begin_s) {
    MESSAGE("not judged: the machine, or the service of the device, stalled before the first command");
    return;
  }
  const auto isFree = [&](const TraceRow& row) { return row.time_s >= begin_s && row.force_N == DVec3(0); };
  CHECK(std::ranges::count_if(rows, isFree) == 0);
  CHECK(excess_N(rows, begin_s) < 1e-9);
}

}  // namespace

TEST_CASE("commands reach a pressing stylus without a knock, on palpate's thread and on a driver's" * kMoreInFull *
          kClock) {
  const DVec3 offset(0, 30, 0);  // the sphere's pole is at y = 20 of the device
  SUBCASE("a simulated Touch") {
    checkStorm([] { return std::make_unique<SimulatedTouch>(Path(kPressing), WorkspaceMap{}); }, offset);
  }
  SUBCASE("OpenHaptics, on the driver's thread") {
    const FakeDriver driver("fake_hd", "", "0,0,26,0\n0.1,0,26,0\n0.5,0,17,0\n");
    checkStorm([] { return std::make_unique<OpenHapticsDevice>(OpenHapticsOptions{}); }, offset);
  }
  SUBCASE("a Haply, on palpate's thread") {
    std::optional<FakeHaply> service;
    checkStorm(
        [&] {
          service.emplace(FakeHaplyOptions{.hand = kPressing});
          return std::make_unique<HaplyDevice>(HaplyOptions{});
        },
        offset - FakeHaply::kMiddle_mm);
  }
}

}  // namespace palpate::device_storm_test
