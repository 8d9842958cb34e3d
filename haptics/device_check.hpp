// A guided test of a device in a hand: free space, directions, and a wall of rising stiffness.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/contact_query.hpp"
#include "haptics/devices/device_axes.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {

/// Detects the hum of an unstable contact: a motion above 20 Hz, faster than any tremor of a hand, whose force is a
/// share of the contact's mean force, and which lasts without decaying. The ringing after an impact decays.
class Oscillation {
 public:
  static constexpr double kCorner_Hz = 20;
  /// Begins above the first share of the mean force and ends below the second one; below kSmallest_N nothing is felt.
  static constexpr double kBegins = 0.15, kEnds = 0.08, kSmallest_N = 0.05;
  /// Until it is believed, if its power meanwhile stays above this share of its maximum.
  static constexpr double kLasts_s = 0.05, kSustained = 0.6;

  /// `depth_mm`: below the wall, negative outside. True once the oscillation has lasted.
  bool update(double depth_mm, double stiffness_N_per_mm, double dt_s) noexcept;
  void reset() noexcept { *this = {}; }
  /// Since it began or last decayed; 0 if there is none.
  double duration_s() const noexcept { return sustained_s_; }

 private:
  bool known_ = false;
  double position_mm_ = 0, once_mm_ = 0, fast_mm_ = 0;  ///< high-passed once and twice
  double power_mm2_ = 0, mean_N_ = 0;
  bool isOn_ = false;
  double maxPower_mm2_ = 0, sustained_s_ = 0;  ///< since it began or last decayed
};

/// What the person is asked to do now.
enum class DeviceCheckStage : std::uint8_t { freeSpace, right, up, towards, lean, lift, leanAgain, done };
/// One sentence for the person.
std::string_view instructionOf(DeviceCheckStage stage);

struct DeviceCheckOptions {
  double rate_Hz = 1000;
  double freeSpace_s = 3;
  double stageTimeout_s = 30;  ///< for each stage; then the test ends with what it knows
  double softest_N_per_mm = 0.1, stiffest_N_per_mm = 4, factor = 1.15;  ///< steps of the wall
  bool realtime = true;                     ///< false: in virtual time, for a simulated device
  SteppedClock* clock = nullptr;            ///< as in ServoOptions
  const std::atomic<bool>* stop = nullptr;  ///< ends the test early
};

/// Results of the device test.
struct DeviceCheckResult {
  std::uint64_t poses = 0, changedPoses = 0;  ///< in free space; changed: differs from the one before
  double freeSpace_s = 0, largestGap_s = 0;
  double noise_mm = 0;        ///< RMS of the position's noise along its noisiest axis
  double freeForce_N = 0;     ///< largest force in free space; must be 0
  std::array<int, 3> axes{};  ///< axis and sign of the pose as the hand moves right, up, towards the user: 1 is +x, -3
                              ///< is -z; 0: it was not moved
  double triedStiffness_N_per_mm = 0;              ///< stiffest wall that was leaned on
  std::optional<double> stableStiffness_N_per_mm;  ///< stiffest wall without oscillation; empty: none
  bool oscillated = false;                         ///< an oscillation ended the steps
  double oscillation_s = 0;                        ///< longest one, from Oscillation::kBegins until the force was zero
  double leastEnergy_mJ = 0;                       ///< minimum energy that the wall took in (Passivity)
  double peakForce_N = 0;
  std::string fault;  ///< of the device, in words; empty if it did not fail

  /// Stiffness for sessions: kStiffnessMargin of the stiffest wall without oscillation.
  std::optional<double> offeredStiffness_N_per_mm() const;
  bool axesAreRight() const { return axes == std::array{1, 2, 3}; }
  /// The axes with which the stylus moves as the hand does; empty if it does already, or if not all were seen.
  std::optional<DeviceAxes> offeredAxes() const;
};
/// Another grip and another pose have less damping than the tested one.
inline constexpr double kStiffnessMargin = 0.7;

/// The wall and the steps of the test, tick by tick on the servo thread. A sampled spring generates K T / 2 of negative
/// damping, and K T more for each tick of delay, so a wall is stable up to K < 2 b / T (Colgate and Schenkel 1994),
/// with the damping b of device and hand, which no device reports. The energy that the wall returns (Hannaford, Ryu
/// 2002) is larger than what it took in during each motion, stable or not, and is only reported; what ends the test is
/// an oscillation above 20 Hz that does not decay (Oscillation).
class DeviceCheckQuery final : public OneHandQuery {
 public:
  /// Throws UsageError for a stiffness, a factor or a time out of range. The wall is never stiffer than `limits` allow.
  DeviceCheckQuery(const DeviceCheckOptions& options, const DeviceLimits& limits);

  Contact answerTo(const Pose& pose, double budget_us) noexcept override;
  /// May be read on any thread.
  DeviceCheckStage stage() const noexcept { return stage_.load(std::memory_order_relaxed); }
  double stiffness_N_per_mm() const noexcept { return shown_.load(std::memory_order_relaxed); }
  const std::atomic<bool>& isDone() const noexcept { return done_; }
  const DeviceCheckOptions& options() const noexcept { return options_; }
  /// After the last tick.
  const DeviceCheckResult& result() const noexcept { return result_; }

 private:
  void enter(DeviceCheckStage stage, const Pose& pose) noexcept;
  void advance(const Pose& pose, double dt_s) noexcept;
  void freeSpace(const Pose& pose, double dt_s) noexcept;
  void direction(const Pose& pose, int which) noexcept;
  void lean(const Pose& pose, double dt_s) noexcept;
  void lift(const Pose& pose) noexcept;
  void fade(const Pose& pose, double dt_s) noexcept;
  void nextStep() noexcept;

  DeviceCheckOptions options_;
  double most_N_;  ///< of a hand that leans: a stronger force would be limited, and a limited wall is softer
  DeviceCheckResult result_;
  std::atomic<DeviceCheckStage> stage_ = DeviceCheckStage::freeSpace;
  std::atomic<double> shown_ = 0;
  std::atomic<bool> done_ = false;
  bool hasBegun_ = false;
  Pose last_;
  std::array<DVec3, 2> before_{};  ///< the last two positions
  double since_s_ = 0;             ///< begin of the stage
  DVec3 from_mm_{0};               ///< the position then
  DVec3 curvature2_mm2_{0};        ///< sum of squared second differences
  DVec3 up_{0, 1, 0};              ///< of the person, as the pose shows it: the normal of the wall
  double wall_mm_ = 0, depth_mm_ = 0;
  double stiffness_N_per_mm_ = 0;  ///< of the step
  double now_N_per_mm_ = 0;        ///< ramps towards it
  double leaned_s_ = 0;            ///< on this step
  double share_ = 1;               ///< of the force; fades after an oscillation
  double humBegan_s_ = 0;
  Oscillation oscillation_;
};

/// Runs the test on the calling thread, or on the device's if it paces; its options are those of `query`. Every force
/// passes the servo loop's limits and gate, and the last one is zero. Throws UsageError for a rate out of range.
DeviceCheckResult checkDevice(HapticDevice& device, DeviceCheckQuery& query);

}  // namespace palpate
