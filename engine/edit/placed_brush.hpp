// A brush in double precision on the CPU, by the formulas of shaders/shared/brush.h.
#pragma once

#include <algorithm>

#include "engine/contact/surface.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/brush_stroke.hpp"
#include "engine/core/point_state.hpp"
#include "shaders/shared/look_ahead.h"

namespace palpate {

/// The effect of a brush on the points around it, for one position of its tool. Positions relative to the cloud's
/// origin, model units.
class PlacedBrush {
 public:
  /// State in which the stroke found a point; the normal has unit length.
  using Found = shared::FoundPointOf<double>;

  /// `support`: support radius, model units.
  PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool);

  bool has(shared::uint trait) const { return shared::brushHas(brush_, trait); }
  /// Whether points are inserted and removed with it, if the sculpture can.
  bool resamples() const { return resamples_; }
  /// False: the brush has no effect.
  bool acts() const { return tool_.acts != 0; }
  /// Centre of a ball that contains all points that the brush may affect; radius() is its radius.
  const DVec3& center() const { return tool_.middle; }
  double radius() const { return tool_.reach; }
  std::uint32_t stroke() const { return tool_.stroke; }
  /// Whether points may be inserted in this edit.
  bool fills() const { return tool_.closes == 0; }
  /// Whether the room of a point may block a step, and whether it blocks that to `free`, its position with any room.
  bool mayBlock(const Found& found) const { return shared::mayBlock(brush_, found); }
  bool isBlocked(const DVec3& place, const Found& found, const DVec3& free) const {
    return shared::isBlocked(brush_, place, found, free);
  }
  /// A point as another one sees it.
  struct Seen {
    DVec3 position, normal;
    bool isOfStroke = false;  ///< this stroke has moved it
    bool stays = false;       ///< no brush moves it
  };
  /// The path of a point that this stroke has moved. `spacing`: its target, model units.
  using Path = shared::PathOf<double>;
  Path path(const DVec3& place, const Found& found, double spacing) const;
  /// How far it may go on, `free` at most, if it sees another point; model units.
  double freeUntil(const Path& path, const Seen& seen, double free) const;
  /// The same beside a point without room, at `place`; `blocked`: as the stroke found that one.
  double freeBeside(const Path& path, const DVec3& place, const Found& blocked, double free) const;
  /// Whether a point is in the way of no other, whatever the brush moves, and if it is moved itself, has no such point
  /// in its own way: freeUntil() changes nothing.
  bool isInNoWay(const Seen& seen) const;

  /// False: the brush has no effect on a point here, however the stroke found it. Cheaper than the effect itself.
  bool mayAffect(const DVec3& place) const;
  struct Point {
    DVec3 position;
    bool taken = false;  ///< the point is removed
  };
  /// New state of a point that depends only on the point itself: for every brush but smooth, and paint, which moves
  /// nothing. `normal`: the current one, unit. Outside the tool's reach, if the brush does not act, and,
  /// except for carve, if it is not connected with the surface under the hand, the point stays.
  Point brushed(const DVec3& place, const DVec3& normal, const Found& found) const;
  /// Whether smooth moves a point, if its neighbours define a surface.
  bool smooths(const DVec3& place, const Found& found) const;
  /// Smooth: new position of a point. `surface`: the algebraic sphere fitted to its neighbours (SurfaceKind::sphere).
  DVec3 smoothed(const DVec3& place, const Found& found, const SurfaceSample& surface) const;
  /// The colour of a point, RGBA8 or 0 for none, after one edit of paint.
  std::uint32_t painted(const DVec3& place, const Found& found, std::uint32_t color) const;
  /// Whether a point is among those that are measured; `id`: constant over the edits.
  bool measures(std::uint32_t id) const { return shared::isSampled(id, tool_.sampling); }
  /// Its contribution to the measure of the surface under the tool.
  shared::MeasuredPoint measured(const Found& found) const;
  /// Adds it to the measure if the brush acts on the point, and the point's cell.
  void measure(const DVec3& place, const Found& found, SurfaceMeasure& measure) const;

 private:
  bool actsOn(const Found& found) const;
  bool movesAlong(const Seen& seen) const;

  shared::BrushOf<double> brush_;
  BrushStroke::Tool tool_;
  bool resamples_;
};

// Whether it is in the ball or the shaft, with a margin for rounding.
inline bool PlacedBrush::mayAffect(const DVec3& place) const {
  if (has(shared::kMeasuresFound)) return true;
  constexpr double kMargin = 1e-6;
  const DVec3 offset = place - tool_.center;
  const double along = has(shared::kHasShaft) ? std::clamp(glm::dot(offset, tool_.outward), 0.0, tool_.shaft) : 0.0;
  const DVec3 fromAxis = offset - along * tool_.outward;
  return glm::dot(fromAxis, fromAxis) <= (1 + kMargin) * brush_.radius * brush_.radius;
}

}  // namespace palpate
