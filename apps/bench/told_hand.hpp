// A hand that goes where a bench tells it to, and notes when it was there and when its force changed.
#pragma once

#include <atomic>

#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// Places are model units. The bench tells it what to do on one thread; ticks are on another one. Times are of `clock`.
class ToldHand final : public HapticDevice {
 public:
  /// The clock outlives it. Where `place` is, it waits first.
  ToldHand(const Stopwatch& clock, const DVec3& place) : clock_(clock) { goTo(place, true); }

  // For the bench.
  /// From the next tick on; where it is put down there was no motion in between.
  void goTo(const DVec3& place, bool isPutDown);
  /// When it was first where it was told to go last; nothing before that.
  std::optional<double> arrived_s() const;
  struct Felt {
    DVec3 force_N{0};
    double since_s = 0;  ///< it has been so, within what a watch takes for a change
    double now_s = 0;
  };
  Felt felt() const { return felt_.load().value_or(Felt{}); }
  /// From now on the first change of the force is noted.
  void watch();
  /// When that was; nothing before.
  std::optional<double> changed_s() const;

  std::string_view name() const override { return "told"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override {}  // there is nothing that could pull
  std::string faultText() const override { return {}; }

 private:
  struct Target {
    DVec3 place{0};
    std::uint64_t number = 0;
    bool isPutDown = false;
  };
  struct Arrival {
    std::uint64_t number = 0;
    double time_s = 0;
  };
  const Stopwatch& clock_;
  std::uint64_t told_ = 0;
  LatestValue<Target> target_;
  LatestValue<Arrival> arrival_;
  LatestValue<Felt> felt_;
  std::atomic<bool> isWatching_ = false;
  std::atomic<double> changed_s_ = -1;
  // The ticks' own.
  Target now_;
  Felt last_;
};

}  // namespace palpate
