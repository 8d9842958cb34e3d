// The surface of a cloud before it was edited, and how a stroke has carried it: in double precision, independent of the
// code that edits. With these a stroke is judged.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// Points of a PointTree, nearest first.
struct NearestPoints {
  static constexpr std::size_t kMax = 48;  ///< candidates, from which the points of one sheet are chosen
  std::array<std::uint32_t, kMax> points;
  std::array<double, kMax> squared;  ///< distances, model units squared
  std::size_t count = 0;
};
NearestPoints nearestTo(const PointTree& tree, const DVec3& place);

/// Whether the normal of a point shows which side is outside: in noise it may lie along the plane of its neighbours, or
/// there is no plane. `tree`: of the points.
bool tellsItsSide(const PointCloud& cloud, const PointTree& tree, std::uint32_t point);

/// The normal of a point of the cloud before, rotated as its sheet was bent: the cross product of the transformed
/// tangent directions, from the displacements of its neighbours on the same side. Empty if they were crushed so that
/// they show no direction. `tree`: of the points before. `after[i]` has the number i.
std::optional<DVec3> carriedNormal(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                                   std::uint32_t point);

class SurfaceBefore {
 public:
  /// Keeps a view of the cloud, which must have normals and outlive this.
  explicit SurfaceBefore(const PointCloud& before);

  const PointTree& tree() const { return tree_; }
  /// Local spacing: mean over the nearest of its points that face the same way as `facing`. Each point's area is that
  /// of the disc that holds its neighbours. Model units; infinite for a single point.
  double spacingAt(const DVec3& place, const DVec3& facing);
  /// Height above the surface, model units; negative inside. Also negative if some of the nearest points' tangent
  /// planes leave the position inside, so that a round fit of a sharp edge puts no point outside. For noisy points the
  /// surface is as high as the highest of the points nearest to the position. Infinite without points.
  double heightAt(const DVec3& place) const;

 private:
  DVec3 position(std::size_t i) const { return DVec3(before_.positions[i]); }
  DVec3 normal(std::size_t i) const { return DVec3(before_.normals[i]); }
  double spacingOf(std::uint32_t point);

  const PointCloud& before_;
  PointTree tree_;
  std::vector<double> spacings_;  // by point, computed on demand; else 0
};

}  // namespace palpate
