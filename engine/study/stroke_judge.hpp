// Judges a single stroke by the points before and after and by the hand's path alone: whether it tore the surface,
// raised it, turned it over, or went where it must not. In double precision and independent of the code that edits.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "engine/core/brush.hpp"
#include "engine/study/surface_before.hpp"

namespace palpate {

/// What a hand did; millimetres where a name says so, else model units from the cloud's origin.
struct PlayedStroke {
  BrushKind brush = BrushKind::push;
  double radius_mm = 0, depth_mm = 0, yield_mm = 0, drag_mm = 0;  ///< of the ball, of the HIP; along the surface
  double lift_mm = 0;   ///< height above the surface to which the hand leaves: a grab goes with it
  bool isOpen = false;  ///< it starts at a border, or somewhere so thin that the depth cannot be demanded
  double mm_per_unit = 1;
  std::vector<DVec3> spots, normals;  ///< of the surface before under the hand, and the outward axis there

  bool presses() const { return brushHas(brush, shared::kHasShaft); }
  bool removes() const { return brushHas(brush, shared::kRemovesPoints); }
};

/// Limits of a stroke that is not broken.
struct StrokeTolerance {
  static constexpr double kRaised_mm = 0.6;      ///< push and carve: height above the surface before
  static constexpr double kOverDepth_mm = 0.5;   ///< the other brushes: height beyond the hand's depth
  static constexpr double kShare = 0.005;        ///< of the region's points, for turned normals and shreds
  static constexpr std::size_t kFewest = 2;      ///< points, for the same
  static constexpr double kCrowd = 2;            ///< times the points that the new area needs
  static constexpr double kDeeper = 0.25;        ///< share of the expected depth that a stroke may be deeper
  static constexpr double kDepthSlack_mm = 0.4;  ///< in addition
  static constexpr double kRough = 0.3;          ///< spacings, also in addition for a deep stroke
  static constexpr double kShallow = 0.5;        ///< share of the expected depth that a push must reach
  static constexpr double kFar_mm = 0.3;         ///< motion of points that face away from the tool
};

struct StrokeVerdict {
  std::size_t region = 0;   ///< points near changed ones, after the stroke
  std::size_t changed = 0;  ///< points that moved, are new, or were removed
  std::size_t regionBefore = 0, inserted = 0, removed = 0;
  double raised_mm = 0;          ///< largest height of a changed point above the surface before
  std::size_t raisedPoints = 0;  ///< points that are higher than they may be
  std::size_t through = 0;       ///< of these, points above a surface that faced away from theirs
  std::size_t turned =
      0;  ///< normals against the side to which the surface has carried them; carve: and away from the tool
  std::size_t shreds = 0, shredsBefore = 0;  ///< points with hardly a neighbour, or off the plane of their neighbours
  std::size_t needed = 0;                    ///< points that the region may need at the spacing before
  double deepest_mm = 0;   ///< largest motion inwards along the stroke's axis; carve: depth under the surface before
  double expected_mm = 0;  ///< depth less the yield depth; at least 0
  double farMoved_mm = 0;  ///< largest motion of a point that faced away from the tool
  std::size_t pairs = 0, folded = 0;  ///< neighbours before; those of them that have passed each other
  bool raises = false, turns = false, crowds = false, tears = false, goesDeep = false, goesShallow = false,
       movesFar = false, folds = false;

  std::vector<std::string_view> broken() const;
  /// The larger the worse; 0 for a stroke that is not broken.
  double badness() const;
};

/// The names that StrokeVerdict::broken() gives.
std::span<const std::string_view> strokeCriteria();

class StrokeJudge {
 public:
  /// Keeps a view of the cloud, which must have normals and outlive this.
  explicit StrokeJudge(const PointCloud& before) : before_(before), surface_(before) {}

  /// `after[i]` has the number i, the cloud's own points first.
  StrokeVerdict judge(std::span<const PointState> after, const PlayedStroke& stroke);

  const PointTree& tree() const { return surface_.tree(); }
  double spacingAt(const DVec3& place, const DVec3& facing) { return surface_.spacingAt(place, facing); }

 private:
  std::uint32_t ancestorOf(std::span<const PointState> after, std::uint32_t i) const;
  bool leadsOut(const DVec3& from, const DVec3& to);
  std::size_t turnedIn(std::span<const PointState> after, std::span<const char> near, const PlayedStroke& stroke) const;

  const PointCloud& before_;
  SurfaceBefore surface_;
};

}  // namespace palpate
