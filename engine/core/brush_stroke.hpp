// Position of the tool while a hand sculpts: the same for every back end, in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/core/brush.hpp"
#include "engine/core/connected_cells.hpp"
#include "engine/core/contact_query.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// Sums over the points that a tool measures (shaders/shared/brush.h). The integers may wrap around: the sums of one
/// edit are the difference of two measures.
struct SurfaceMeasure {
  std::uint32_t weights = 0;
  std::array<std::uint32_t, 3> normals{};
  std::uint32_t heights = 0;
  std::uint32_t blocked = 0;  ///< points that had no room for their step
  // Results for the points that the stroke found around the hand; a difference has those of the later measure.
  SheetCells seen{};                             ///< their cells
  shared::uint nearest = shared::kOutsideSheet;  ///< smallest of their results of entered()

  void add(const shared::MeasuredPoint& point);
  void add(const SurfaceMeasure& other);
  void enter(shared::uint entered);  ///< result of entered()
  friend SurfaceMeasure operator-(const SurfaceMeasure& a, const SurfaceMeasure& b);
};

/// Points that the last edit left to the next ones, where the work of an edit is limited.
struct Backlog {
  double strain = 0;   ///< the furthest of them has moved so far since it was last resampled, support radii
  bool waits = false;  ///< whether there are any
};

/// Consecutive strokes. The tool is fixed to the hand: it follows the path of the HIP, no faster than the points can
/// yield, and completes that path after the hand has left, so that the result does not depend on how many edits a
/// machine carries out. Its axis is the normal of the surface as the stroke found it, averaged over the brush; the
/// direction from HIP to proxy is not used, since the proxy trails in a drag. While the hand withdraws, only grab acts.
/// A brush acts on the part of the surface that is connected with the surface under the hand, as the edit before has
/// found it; at first that is at most a few cells around the hand. A hand that has gone through a thin part, or
/// around its rim, does nothing until it is back at the side of the stroke, two brush radii away, or released.
/// A stroke is one press of the button, or one contact of a hand without a button, with gaps of up to 0.3 s.
/// Positions are relative to the cloud's origin, in model units. Allocates nothing.
class BrushStroke {
 public:
  struct Tool : shared::BrushToolOf<double> {
    SheetCells connected{};  // of the grid at connectedFrom: the cells on which the brush acts
  };

  /// `support`: support radius, model units.
  explicit BrushStroke(double support) : support_(support) {}

  /// Replaces the brush. Ends the stroke.
  void setBrush(const BrushOptions& brush);
  /// Processes the answer to a pose with its HIP at `hip`; the contact's proxy is at hip + spring. Called in order of
  /// time.
  void feel(const Contact& contact, const DVec3& hip, const DVec3& spring, Press press, double time_s);
  /// Whether a part of the hand's path remains.
  bool hasWay() const { return wayCount_ > 0; }
  /// Ends the stroke: the remaining path is dropped.
  void end();
  /// Ends the stroke, and begins none before the hand has left the surface, or has released its button.
  void awaitRelease();
  /// Forgets the hand and all strokes, except for their number.
  void restart();
  /// The hand is put down elsewhere: the tool skips the path in between. The remaining path before it is still
  /// followed.
  void lift();

  /// Whether a stroke is in progress or a part of its path remains.
  bool isGoingOn() const { return open_ || hasWay(); }
  /// Whether an edit with next() would have an effect.
  bool acts() const { return acts_ || hasWay(); }
  /// Moves the tool along its path, for an edit at `time_s`. The tool slows down, and finally stops, while points that
  /// the last edit moved far are not yet resampled. It acts only if this stroke acts.
  const Tool& next(double time_s, const Backlog& backlog = {});
  /// The tool that the last next() returned.
  const Tool& tool() const { return tool_; }
  /// Takes in the measure of the edit with that tool.
  void note(const SurfaceMeasure& measure);

  std::uint32_t number() const { return number_; }

 private:
  static constexpr std::size_t kMaxWay = 1024;
  struct Place {
    DVec3 hip{0};
    bool jumps = false;  // the surface did not yield on the path to here; outward then applies
    DVec3 outward{0};    // outward direction of the surface here
    DVec3 found{0};      // position of the surface here: of the proxy
  };

  void begin(const Place& place);
  void noteSide(const Place& place);
  void goOnTo(const Place& place);
  void advance(double most);
  double halfWidth() const;
  double longestStep(double share) const;
  double pushShare(double share) const;
  bool has(shared::uint trait) const { return brushHas(brush_.kind, trait); }
  double found() const { return glm::dot(foundAt_ - place_, outward_); }
  std::uint32_t sampling() const;
  DVec3 sheetCorner() const;
  double sheetCell() const;
  void beginSheet();
  void takeIn(const SurfaceMeasure& measure);
  bool isBelow(const DVec3& hip) const;
  void placeTool();
  DVec3 held() const;
  double steepestAhead(const DVec3& motion) const;

  double support_;
  BrushOptions brush_;
  std::uint32_t number_ = 0;
  bool open_ = false, acts_ = false, knowsLast_ = false, touched_ = false, isLifted_ = false;
  bool yielded_ = false;  // the surface yielded at the last answer
  bool awaitsRelease_ = false;
  bool brokeThrough_ = false;  // the hand is at another side of the model than the stroke
  bool cutsOn_ = false;        // it removes points, and need not be held back by them
  double lastTouch_s_ = 0, lastEdit_s_ = 0;
  bool edited_ = false;          // whether this stroke has edited
  std::uint32_t idleEdits_ = 0;  // edits since the last with an effect, kMaxFilling at most
  DVec3 lastHip_{0};             // HIP of the last answer
  DVec3 outward_{0, 0, 1};       // outward normal of the surface as the stroke found it
  DVec3 foundAt_{0};             // a position on that surface
  DVec3 place_{0};               // position of the hand that the tool has reached
  DVec3 touchedAt_{0};           // position of the proxy when the hand was at place_
  DVec3 connectedFrom_{0};       // corner of the grid of the connected cells
  SheetCells connected_{};
  bool measuredSheet_ = false;     // whether an edit has measured them
  DVec3 heldAt_{0}, heldFrom_{0};  // grab: position of the held surface and of the hand at the start
  // Remaining path, a ring buffer.
  std::array<Place, kMaxWay> way_;
  std::size_t wayFirst_ = 0, wayCount_ = 0;
  Place side_;  // with the position of the hand at its last touch
  Tool tool_{};
};

/// A brush in double precision, as the formulas use it. `support`: support radius, model units. Checks the ranges of
/// its options.
shared::BrushOf<double> brushOf(const BrushOptions& options, double support);
/// The brush, and the tool, as shaders read them.
shared::Brush sharedBrush(const BrushOptions& options, double support);
shared::BrushTool sharedTool(const BrushStroke::Tool& tool);
shared::PlacedTool placedTool(const BrushStroke::Tool& tool);

}  // namespace palpate
