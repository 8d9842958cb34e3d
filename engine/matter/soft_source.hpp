// The points of a soft body that hands press on: a source of frames that follow the time of a simulation.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/brush_stroke.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/core/tool_shape.hpp"
#include "engine/edit/placed_brush.hpp"
#include "engine/matter/contact_keeper.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_sculpture.hpp"
#include "engine/matter/stepped_control.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// A brush on a soft body.
/// One tick of a brush that works on soft bodies (shared::kShapesBodies), by the formulas for any cloud: the body
/// yields by the displacements that the brush would give its surface positions, as pressed in by the hand. A unit of
/// the brush's lengths is `unit_m`. Returns the measure of the surface under the tool.
SurfaceMeasure sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m);

/// Maximum number of hands and points of the first hand's tool.
inline constexpr std::size_t kMaxTouches = kMaxToolPoints + kMaxHands;

/// A hand, or a point of its tool, at the surface: its contact at one tick, and its position at the next. Model units.
struct SurfaceTouch {
  bool touching = false;
  std::uint32_t contact = 0;               ///< contact number while it touches (ContactKeeper)
  bool isSamePlace = false;                ///< borne by the same nodes as before
  DVec3 proxy{0}, normal{0}, velocity{0};  ///< of the felt surface
  DVec3 hip{0};                            ///< at the next tick
  HandSpring spring;                       ///< its share of the hand's spring
  std::uint32_t hand = 0;
  double felt = 1;  ///< share of the spring's force, limited to its maximum, that the hand receives
};

/// The first hand's brush at its contact.
struct SurfaceBrush {
  std::optional<BrushOptions> brush;   ///< model units
  Press press = Press::none;           ///< whether the hand requests sculpting
  bool touching = false;               ///< the hand touches
  DVec3 hip{0}, spring{0}, normal{0};  ///< from HIP to proxy; of the surface there
};

/// All touches at a tick. Those of one hand are contiguous.
struct SurfaceQuestion {
  double time_s = 0;        ///< time of `hip`
  double feltAt_s = 0;      ///< time of the previous tick, to which the proxies belong
  double pointsTime_s = 0;  ///< time of the frame in which they were felt
  double friction = 0;
  bool goesOn = false;  ///< a tick was later than the points that it felt: compliances are needed
  SurfaceBrush brush;
  std::uint32_t count = 0;
  std::array<SurfaceTouch, kMaxTouches> touches;
};

/// Pressed position of each touch.
using PressedPlaces = std::array<PressedPlace, kMaxTouches>;

struct SoftSourceOptions {
  std::size_t points = 0;  ///< points of the surface
  std::size_t hands = 1;
  double radius = 0;             ///< support radius of the felt surface, model units
  double toolReach = 0;          ///< distance from the first hand's HIP to its farthest tool point, model units
  std::uint32_t mostAtOnce = 0;  ///< maximum steps per frame; further steps are dropped; 0: unlimited
};

/// Follows the hands step by step to the time of each requested frame, and presses where they touched in the previous
/// frame; a brush acts in each step, too. If time goes back the scene restarts, in its present shape. So a frame's
/// bytes depend on all earlier questions, and in virtual time on the poses. ask() is for one thread, makeFrame(),
/// goTo() and hasNewer() for one other thread, the rest for any thread.
class SoftSource final : public CloudSource, public SteppedControl {
 public:
  /// `world` must have a surface.
  SoftSource(std::unique_ptr<MatterSimulation> world, const SoftSourceOptions& options);

  /// Sets the state of the hands. Allocates nothing and does not wait.
  void ask(const SurfaceQuestion& question) noexcept { asked_.store(question); }

  /// Positions on the body that touches press on; nullopt while they are being written. Allocates nothing and does not
  /// wait.
  std::optional<PressedPlaces> pressed() const noexcept { return pressed_.load(); }
  double radius() const noexcept { return options_.radius; }
  /// Counts of kept contacts and of ticks in which the body gave way, for reports.
  SurfaceHolds surfaceHolds() const noexcept override;
  void count(bool isKept, bool gaveWay) noexcept;

  std::size_t size() const override { return options_.points; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;
  FrameCarrier* carrier() override { return world_->carrier(); }
  std::optional<double> goTo(double time_s) override;

  /// Compliance of the surface under a hand, model units per N: that of an elastic half-space (Love 1929) until the
  /// body's own has been computed.
  double compliance(std::size_t hand) const noexcept { return compliances_[hand].load(std::memory_order_relaxed); }
  /// Number of discontinuities of the surface: restarts of the scene, and strokes undone or redone.
  std::uint32_t beginnings() const noexcept { return beginnings_.load(std::memory_order_relaxed); }

  /// Ends the stroke. Only while no frame is being made.
  void endStroke();
  /// ShapeStrokes::take() and exchange(), which the next frame shows; exchange() only while no frame is being made.
  void takeStrokes(std::vector<ShapeStroke>& strokes);
  void exchange(ShapeStroke& stroke);

  const MatterSimulation& world() const { return *world_; }

 private:
  // State of a touch in the simulation.
  struct Slot {
    bool known = false;    // hand_m is valid
    bool presses = false;  // the touch presses on the surface
    DVec3 hand_m{0}, place_m{0};
    DVec3 velocity_m_s{0};    // of place_m
    bool isAlone = false;     // PressReport::isAlone
    std::uint32_t steps = 0;  // number of steps pressed without interruption
  };
  void restart();
  void follow(double time_s);
  void sculpt(std::uint32_t steps);
  void edit(SoftSculpture& sculpture, double time_s, std::uint32_t steps);
  void advance(std::uint32_t steps);
  void tellPlaces();
  DVec3 placeOf(const SurfaceTouch& touch, const Slot& slot) const;
  void findCompliance(const SurfaceTouch& touch, const Slot& slot, std::uint32_t steps);

  std::unique_ptr<MatterSimulation> world_;
  SoftSourceOptions options_;
  LatestValue<SurfaceQuestion> asked_;
  LatestValue<PressedPlaces> pressed_;
  PressedPlaces told_;  // the last stored positions
  SurfaceQuestion question_;
  std::optional<BrushOptions> brush_;  // brush of the stroke
  BrushStroke stroke_;
  std::vector<Slot> slots_;
  std::vector<SurfacePress> presses_;
  std::vector<std::size_t> pressing_;           // index of each press's touch
  std::array<double, kMaxHands> energies_J_{};  // energy input of the hands since the start
  double bodyTime_s_ = 0;                       // time of the body's state, in the questions' time
  std::array<std::atomic<double>, kMaxHands> compliances_;
  std::atomic<std::uint32_t> beginnings_ = 0;
  std::atomic<std::uint64_t> keptTicks_ = 0, gaveWayTicks_ = 0;
  double pace_ = 1;  // ratio of the body's time to the hands' time in the last steps: below 1 if steps were dropped
  bool isTurned_ = false;  // a stroke was undone or redone since the last frame
};

}  // namespace palpate
