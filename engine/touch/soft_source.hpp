// The points of a soft body, where hands press on it: a source of frames whose time is that of a simulation.
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
#include "engine/core/touch_backend.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/contact_keeper.hpp"
#include "engine/touch/stepped_control.hpp"

namespace palpate {

/// Hands, and points of the first one's tool, at most.
inline constexpr std::size_t kMaxTouches = kMaxToolPoints + kMaxHands;

/// A hand, or a point of its tool, at the surface: what it felt at one tick, and where it is at the next. Model units.
struct SurfaceTouch {
  bool touching = false;
  std::uint32_t contact = 0;               ///< its number, where it touches (ContactKeeper)
  bool isSamePlace = false;                ///< the same nodes bear it as before
  DVec3 proxy{0}, normal{0}, velocity{0};  ///< of the surface that was felt
  DVec3 hip{0};                            ///< at the next tick
  HandSpring spring;                       ///< its share of it
  std::uint32_t hand = 0;
  double felt = 1;  ///< share of the spring's force, held to its most, that the hand gets
};

/// The first hand's brush where it felt the surface.
struct SurfaceBrush {
  std::optional<BrushOptions> brush;   ///< model units
  bool sculpts = false;                ///< the hand means to
  bool touching = false;               ///< it does
  DVec3 hip{0}, spring{0}, normal{0};  ///< from HIP to proxy; of the surface there
};

/// All of them at a tick. Those of one hand stand together.
struct SurfaceQuestion {
  double time_s = 0;        ///< of `hip`
  double feltAt_s = 0;      ///< the tick before, to which the proxies belong
  double pointsTime_s = 0;  ///< of the frame in which they were felt
  double friction = 0;
  bool goesOn = false;  ///< a tick was later than the points that it felt: somebody asks for compliances
  SurfaceBrush brush;
  std::uint32_t count = 0;
  std::array<SurfaceTouch, kMaxTouches> touches;
};

/// For each touch where it presses.
using PressedPlaces = std::array<PressedPlace, kMaxTouches>;

struct SoftSourceOptions {
  std::size_t points = 0;  ///< of the surface
  std::size_t hands = 1;
  double radius = 0;             ///< support radius of what is felt, model units
  double toolReach = 0;          ///< of the first hand's tool, from its HIP, model units
  std::uint32_t mostAtOnce = 0;  ///< steps for a frame; those beyond it are left out; 0: any number
};

/// Follows the hands step by step to the time of each frame that is asked for, and presses where they touched in the
/// frame before; so does a brush, in each of the steps. Where time goes back the scene begins anew, in the shape that
/// it has. So a frame's bytes follow from all that was asked before, and in virtual time from the poses. ask() is for
/// one thread, makeFrame(), goTo() and hasNewer() for another one, and the rest for any.
class SoftSource final : public CloudSource, public SteppedControl {
 public:
  /// `world` has a surface.
  SoftSource(std::unique_ptr<MatterSimulation> world, const SoftSourceOptions& options);

  /// Where hands are from now on. Allocates nothing and waits for nobody.
  void ask(const SurfaceQuestion& question) noexcept { asked_.store(question); }

  /// Where the body carries what touches press on; nothing while it is being written. Allocates nothing and waits for
  /// nobody.
  std::optional<PressedPlaces> pressed() const noexcept { return pressed_.load(); }
  double radius() const noexcept { return options_.radius; }
  /// What hands have felt of it, for whoever is told.
  SurfaceHolds surfaceHolds() const noexcept override;
  void count(bool isKept, bool gaveWay) noexcept;

  std::size_t size() const override { return options_.points; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;
  FrameCarrier* carrier() override { return world_->carrier(); }
  std::optional<double> goTo(double time_s) override;

  /// How far the surface under a hand gives way for a force on it, model units per N: that of an elastic half-space
  /// (Love 1929) until the body has been asked for its own.
  double compliance(std::size_t hand) const noexcept { return compliances_[hand].load(std::memory_order_relaxed); }
  /// How often the surface has stood somewhere else all at once: the scene has begun anew, or a stroke was taken back.
  std::uint32_t beginnings() const noexcept { return beginnings_.load(std::memory_order_relaxed); }

  /// While no frame is being made: the stroke is over; the last one is taken back, or done again, of which the next
  /// frame tells. False where there is none.
  void endStroke();
  bool undo();
  bool redo();
  /// For any thread.
  StrokeCounts strokes() const noexcept;

  const MatterSimulation& world() const { return *world_; }

 private:
  // A touch as the simulation knows it.
  struct Slot {
    bool known = false;    // where the hand was
    bool presses = false;  // the surface has a place for it
    DVec3 hand_m{0}, place_m{0};
    DVec3 velocity_m_s{0};    // of the place
    bool isAlone = false;     // PressReport::isAlone
    std::uint32_t steps = 0;  // that it has pressed on end
  };
  void restart();
  void follow(double time_s);
  void sculpt(std::uint32_t steps);
  void edit(SoftSculpture& sculpture, double time_s, std::uint32_t steps);
  bool turn(bool (*to)(SoftSculpture&));
  void countStrokes();
  void advance(std::uint32_t steps);
  void tellPlaces();
  DVec3 placeOf(const SurfaceTouch& touch, const Slot& slot) const;
  void findCompliance(const SurfaceTouch& touch, const Slot& slot, std::uint32_t steps);

  std::unique_ptr<MatterSimulation> world_;
  SoftSourceOptions options_;
  LatestValue<SurfaceQuestion> asked_;
  LatestValue<PressedPlaces> pressed_;
  PressedPlaces told_;  // what was stored last
  SurfaceQuestion question_;
  std::optional<BrushOptions> brush_;  // of the stroke
  BrushStroke stroke_;
  std::vector<Slot> slots_;
  std::vector<SurfacePress> presses_;
  std::vector<std::size_t> pressing_;           // of which touch each press is
  std::array<double, kMaxHands> energies_J_{};  // that hands have put in since the beginning
  double bodyTime_s_ = 0;                       // the questions' time for which the body is as it is
  std::array<std::atomic<double>, kMaxHands> compliances_;
  std::atomic<std::uint32_t> beginnings_ = 0;
  std::atomic<std::uint64_t> keptTicks_ = 0, gaveWayTicks_ = 0;
  double pace_ = 1;  // of the body's time against that of the hands, in the last steps: less where some were left out
  bool isTurned_ = false;  // a stroke was taken back since the last frame
  struct Counts {
    std::atomic<std::uint64_t> strokes = 0, dropped = 0, version = 0;
    std::atomic<std::size_t> undoable = 0, redoable = 0;
  } counts_;
};

}  // namespace palpate
