// Whether an edit changed only what it may: in double precision, from the points before and after and the brush's way
// alone, and with nothing of what edits them.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// What a brush did, as whoever moved it knows.
struct BrushPath {
  std::vector<DVec3> centers;   ///< of the brush's ball in each tick in which it acted; model units, relative to the
                                ///< cloud's origin
  double radius = 0;            ///< model units
  double support = 0;           ///< support radius, model units
  double reachSlack = 0;        ///< support radii by which the way may be off, besides EditTolerance::kReach
  bool carves = false;          ///< what it leaves faces the ball, and nothing new may stand outside
  bool pushes = false;          ///< what it touches ends on the ball's wall
  std::optional<double> depth;  ///< of the tip under the surface as it was, at most; model units
  double depthSlack = 0;        ///< that a stroke may be off, besides EditTolerance::kDepth
  std::optional<double> mostRaised;  ///< over the surface as it was; nothing: the brush raises
};

/// What is allowed for: the judge measures spacings and heights of places anew, from few points, and errs.
struct EditTolerance {
  static constexpr double kReach = 0.01;       ///< support radii that a point may be farther away
  static constexpr double kCrowded = 0.4;      ///< spacings of its place that a new point keeps from others
  static constexpr double kMaxCrowded = 0.02;  ///< share of the new points that may be nearer
  static constexpr double kNearest = 0.25;     ///< spacings that none may be nearer: of an uneven place two measures
                                               ///< differ by a half
  static constexpr double kOutside = 0.5;      ///< spacings of its place that a new point may stand off the old surface
  static constexpr double kMaxOutside = 0.01;  ///< share of the new points that may: noisy scans have no one surface
  static constexpr double kDepth = 0.25;       ///< share of the depth that a stroke may be off
  static constexpr double kMaxDoubled = 0.01;  ///< share of the changed points that may lie on another layer of them
  static constexpr double kMaxTurned = 0.01;   ///< share of the changed points whose normals may face the other way
};

/// Counts points; a point that came and went again counts as nothing.
struct EditVerdict {
  std::size_t moved = 0, painted = 0, inserted = 0, removed = 0;
  double farthestMoved = 0;     ///< of those that moved, have another colour or went: distance of where they were from
                                ///< brush's way beyond its radius, support radii; negative within it
  double farthestInserted = 0;  ///< the same for new points where they are
  std::size_t crowded = 0;      ///< new points nearer than EditTolerance::kCrowded to another of their sheet
  double nearest = 1;           ///< of new points to others of their sheet, spacings of their place or of where they
                                ///< come from, whichever is smaller; 1 at most
  std::size_t outside = 0;      ///< new points off the old surface by more than EditTolerance::kOutside
  double farthestOutside = 0;   ///< of new points, support radii
  double reachSlack = 0;        ///< of BrushPath
  std::size_t changed = 0;      ///< points that moved or are new
  double deepest = 0, highest = 0;  ///< of them, under and over the surface as it was, model units
  std::size_t doubled = 0;          ///< of them, those with another one that faces the other way within half a spacing
  bool wrongDepth = false, raised = false;  ///< against BrushPath, with its allowances
  std::size_t fitted = 0;                   ///< changed points whose normal could be held against a plane fit
  double normal_deg = 0;                    ///< 95th percentile of the angle between the two, of either sign
  std::size_t sided = 0;                    ///< of them, those of which it is known which side is outside
  std::size_t turned = 0;                   ///< of these, those whose normal faces inwards
  std::size_t turnedAtRest = 0;             ///< points that did not move, whose normal faces the other way now

  /// The promises that are broken, in words; empty when none is. By shares of points a promise is broken beyond those
  /// of EditTolerance, and by more than one point; `strict`: by a single point, and with no allowance for reach.
  std::vector<std::string_view> broken(bool carves, bool strict = false) const;
};

class EditJudge {
 public:
  /// Keeps a view of the cloud, which must have normals and outlive this.
  explicit EditJudge(const PointCloud& before);

  /// `after`: `after[i]` has the number i, the cloud's own points first.
  EditVerdict judge(std::span<const PointState> after, const BrushPath& way);

  /// Spacing of the place in the cloud before: mean over the nearest of its points that face the same way as `facing`.
  /// Each has the area of the disc that holds its own neighbours.
  double spacingAt(const DVec3& place, const DVec3& facing);
  /// Height above the surface before; negative inside. Below zero as well where some of the nearest points' tangent
  /// planes leave the place inside, so that a round fit of a sharp edge makes no point stand outside. Where the points
  /// are noisy the surface is as high as the highest of those nearest to the place.
  double heightAt(const DVec3& place) const;

 private:
  struct Sheet {
    const PointTree& tree;
    std::span<const std::uint32_t> numbers;  // in the cloud, of its points; empty: their own
    std::uint32_t numberOf(std::uint32_t i) const { return numbers.empty() ? i : numbers[i]; }
  };
  double heightOver(const Sheet& sheet, const DVec3& place) const;
  double heightFrom(const DVec3& place, std::uint32_t ancestor, double least, double support);
  DVec3 position(std::size_t i) const { return DVec3(before_.positions[i]); }
  DVec3 normal(std::size_t i) const { return DVec3(before_.normals[i]); }
  double spacingOf(std::uint32_t point);
  double spacingFor(const DVec3& place, std::uint32_t ancestor);

  const PointCloud& before_;
  PointTree tree_;
  std::vector<double> spacings_;  // of the points, once they were asked for; else 0
};

/// Distance of `place` from the line that joins `centers`; infinite where there are none.
double distanceToWay(const DVec3& place, std::span<const DVec3> centers);

}  // namespace palpate
