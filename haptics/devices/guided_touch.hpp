// A stylus without a haptic device: a mouse, keys or a gamepad set the intended position, and a simulated Touch moves
// as a real one would in that hand. The stroke of a pointer is drawn: the stylus is where the stroke says.
#pragma once

#include "engine/core/latest_value.hpp"
#include "haptics/devices/drawn_strokes.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// The hand of a user without a device: no friction and no perceptible encoder steps, with stops at the sides of
/// `workspace_mm`.
SimulatedTouchOptions guidedHand(const DVec3& workspace_mm);

/// Maximum speed of a guided hand: that of a quick one.
inline constexpr double kFastestHand_mm_per_s = 600;
/// Number of times that a stroke which will hold what it touches comes down more slowly, below the surface.
inline constexpr double kGripTimes = 8;
/// Distance from the surface at which a drawn stroke puts the stylus down, and to which it lifts it.
inline constexpr double kHover_mm = 4;

struct GuidedOptions {
  double tick_s = 1e-3;  ///< time between two poses of a drawn stroke
  /// DeviceLimits::countsTicks: a stroke whose next pose is not drawn yet waits for it. Otherwise the stylus rests.
  bool countsTicks = false;
  bool catchesUp = false;  ///< a stroke that is far behind its pointer follows it faster
};

/// The hand has inertia and yields to the force: the surface holds the stylus back while the aim sinks in. One thread
/// aims, another one reads and writes; neither waits for the other.
class GuidedTouch final : public HapticDevice {
 public:
  /// `map`: from the device's space to the model's; `parked`: position of the stylus while it is lifted, model units.
  GuidedTouch(const WorkspaceMap& map, const DVec3& parked, const GuidedOptions& options = {});

  // For the thread that aims.
  /// Sets the intended position, model units, and whether the button that sculpts is held. Puts a lifted stylus down
  /// there. False if nothing has changed by it.
  bool aim(const DVec3& place, bool sculpts = true) noexcept;
  /// Takes the stylus away from the model, with its button released.
  void lift() noexcept;
  /// Poses of a stroke, one a tick; from the first one to the one that ends it no aim has an effect. Only with
  /// canDraw().
  void draw(const DrawnPose& pose) noexcept { strokes_.add(pose); }
  bool canDraw() const noexcept { return strokes_.hasRoom(); }
  /// Whether poses are left.
  bool isDrawing() const noexcept { return strokes_.pending() > 0; }
  /// Drops the stroke, while no thread reads.
  void dropStroke() noexcept;
  /// Drops it at the next tick. No pose is drawn before that.
  void giveUpStroke() noexcept { givesUp_ = true; }

  std::string_view name() const override { return "guided stylus"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  void feel(const std::optional<DVec3>& toProxy) noexcept override { toProxy_ = toProxy; }
  bool write(const DVec3& force_N) noexcept override { return hand_.write(force_N); }
  void emergencyStop() noexcept override { hand_.emergencyStop(); }
  bool isStopped() const noexcept override { return hand_.isStopped(); }
  void resume() noexcept override { hand_.resume(); }
  std::string faultText() const override { return {}; }

 private:
  struct Aim {
    DVec3 place{0};
    bool lifted = true, sculpts = false;
    std::uint32_t putDowns = 0;  // number of times the stylus was put down
  };

  DeviceState readStroke() noexcept;
  int takePoses() noexcept;
  void follow(const DrawnPose& pose, int ticks) noexcept;
  bool isLost(const DrawnPose& pose, int ticks) noexcept;
  DVec3 placeOf(const DrawnPose& pose) const noexcept;

  std::atomic<bool> givesUp_ = false;
  WorkspaceMap map_;
  GuidedOptions options_;
  DrawnStrokes strokes_;
  DVec3 parked_;
  LatestValue<Aim> latest_;
  Aim aim_;  // used by the thread that aims
  // Used by the thread that reads.
  Aim last_;
  DVec3 glide_;
  double glideTime_s_ = 0;
  SimulatedTouch hand_;
  std::optional<DrawnPose> pose_;  // of the stroke in progress
  bool wasDrawn_ = false;          // a stroke has ended since the last aim
  DVec3 hip_{0};                   // during a stroke; model units, as the next one
  double inward_ = 0;
  std::optional<double> grip_;    // by how much less deep than the pose it holds what it touched
  double raised_ = 0;             // highest proxy over the stroke's place, since it was put down
  DVec3 lastPosition_{0};         // as it was read last, in the device's unit
  double lost_s_ = 0;             // without contact, or far from it
  std::optional<DVec3> toProxy_;  // at the last tick, in the device's unit; empty without contact
};

}  // namespace palpate
