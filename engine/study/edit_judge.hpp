// Checks that an edit changed only what it may: in double precision, from the points before and after and the brush's
// path alone, independent of the code that edits.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// The path of a brush, as known to the code that moved it.
struct BrushPath {
  std::vector<DVec3> centers;   ///< of the brush's ball in each tick that it acted in; model units, from the origin
  double radius = 0;            ///< model units
  double support = 0;           ///< support radius, model units
  double reachSlack = 0;        ///< uncertainty of the path in support radii, in addition to EditTolerance::kReach
  bool carves = false;          ///< the surface it leaves faces the ball, and no new point may be outside
  bool pushes = false;          ///< touched points end on the ball's wall
  std::optional<double> depth;  ///< maximum depth of the tip under the original surface; model units
  double depthSlack = 0;        ///< additional tolerance of a stroke's depth beyond EditTolerance::kDepth
  std::optional<double> mostRaised;  ///< maximum height over the original surface; empty: the brush raises
};

/// Tolerances: the judge computes local spacings and heights itself, from few points, with errors.
struct EditTolerance {
  static constexpr double kReach = 0.01;       ///< additional distance allowed for a changed point, support radii
  static constexpr double kCrowded = 0.4;      ///< distance that a new point keeps from others, local spacings
  static constexpr double kMaxCrowded = 0.02;  ///< share of the new points that may be nearer
  static constexpr double kNearest = 0.25;     ///< spacings, a minimum: two measures of uneven spacing differ by a half
  static constexpr double kOutside = 0.5;      ///< distance that a new point may be off the old surface, local spacings
  static constexpr double kMaxOutside = 0.01;  ///< share of new points that may: noisy scans have no unique surface
  static constexpr double kDepth = 0.25;       ///< relative tolerance of a stroke's depth
  static constexpr double kMaxDoubled = 0.01;  ///< share of the changed points on another layer of changed points
  static constexpr double kMaxTurned = 0.01;   ///< share of the changed points whose normals may face the other way
};

/// Counts points; a point that was inserted and removed again does not count.
struct EditVerdict {
  std::size_t moved = 0, painted = 0, inserted = 0, removed = 0;
  double farthestMoved = 0;  ///< of moved, recoloured or removed points: distance of their original position from the
                             ///< brush's path beyond its radius, support radii; negative within it
  double farthestInserted = 0;  ///< the same for new points, at their positions
  std::size_t crowded = 0;      ///< new points nearer than EditTolerance::kCrowded to another point of their sheet
  double nearest = 1;       ///< smallest distance of new points to others of their sheet, in local spacings or those of
                            ///< their ancestor, whichever is smaller; 1 at most
  std::size_t outside = 0;  ///< new points off the old surface by more than EditTolerance::kOutside
  double farthestOutside = 0;       ///< maximum of the new points, support radii
  double reachSlack = 0;            ///< BrushPath::reachSlack
  std::size_t changed = 0;          ///< points that moved or are new
  double deepest = 0, highest = 0;  ///< of these, under and over the original surface, model units
  std::size_t doubled = 0;  ///< of these, points with another one that faces the other way within half a spacing,
                            ///< but for the two sides of a part that was thinner than a spacing
  bool wrongDepth = false, raised = false;  ///< compared with BrushPath, within the tolerances
  std::size_t fitted = 0;                   ///< changed points whose normal could be compared with a plane fit
  double normal_deg = 0;                    ///< 95th percentile of the angle between the two, ignoring signs
  std::size_t sided = 0;                    ///< of these, points whose outer side is known
  std::size_t turned = 0;                   ///< of these, those whose normal faces inwards
  std::size_t turnedAtRest = 0;             ///< points that did not move but whose normal faces the other way now

  /// The violated requirements, in words; empty if there are none. A requirement on shares of points is violated above
  /// the share in EditTolerance and by more than one point; `strict`: by a single point, and without tolerance of the
  /// reach.
  std::vector<std::string_view> broken(bool carves, bool strict = false) const;
};

class EditJudge {
 public:
  /// Keeps a view of the cloud, which must have normals and outlive this.
  explicit EditJudge(const PointCloud& before);

  /// `after`: `after[i]` has the number i, the cloud's own points first.
  EditVerdict judge(std::span<const PointState> after, const BrushPath& way);

  /// Local spacing in the cloud before: mean over the nearest of its points that face the same way as `facing`. Each
  /// point's area is that of the disc that holds its neighbours.
  double spacingAt(const DVec3& place, const DVec3& facing);
  /// Height above the surface before; negative inside. Also negative if some of the nearest points' tangent planes
  /// leave the position inside, so that a round fit of a sharp edge puts no point outside. For noisy points the surface
  /// is as high as the highest of the points nearest to the position.
  double heightAt(const DVec3& place) const;

 private:
  struct Sheet {
    const PointTree& tree;
    std::span<const std::uint32_t> numbers;  // numbers of its points in the cloud; empty: the same as in the tree
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
  std::vector<double> spacings_;  // by point, computed on demand; else 0
};

/// Distance of `place` from the line that joins `centers`; infinite if there are none.
double distanceToWay(const DVec3& place, std::span<const DVec3> centers);

}  // namespace palpate
