// A hand that a bench moves, which records the time of arrival and the time of a force change.
#pragma once

#include <atomic>

#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// Positions are in model units. The bench commands it on one thread; ticks run on another. Times are from `clock`.
class ToldHand final : public HapticDevice {
 public:
  /// `clock` must outlive it. It starts at `place`.
  ToldHand(const Stopwatch& clock, const DVec3& place) : clock_(clock) { goTo(place, true); }

  // For the bench.
  /// Takes effect at the next tick. `isPutDown`: a jump without motion in between.
  void goTo(const DVec3& place, bool isPutDown);
  /// When it first reached the last commanded position; empty before that.
  std::optional<double> arrived_s() const;
  struct Felt {
    DVec3 force_N{0};
    double since_s = 0;  ///< time of the last change, within the watch's threshold
    double now_s = 0;
  };
  Felt felt() const { return felt_.load().value_or(Felt{}); }
  /// Records the first change of the force from now on.
  void watch();
  /// Time of that change; empty before it.
  std::optional<double> changed_s() const;

  std::string_view name() const override { return "told"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override {}  // no force to switch off
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
  // Used only by the ticks' thread.
  Target now_;
  Felt last_;
};

}  // namespace palpate
