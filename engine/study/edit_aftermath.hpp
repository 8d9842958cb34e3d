// A cloud after an edit, compared with the cloud before: which points are new, which points are near each other, and
// which way each should face. In double precision, and independent of the code that edits points.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/study/edit_judge.hpp"

namespace palpate {

/// Points of a PointTree, nearest first.
struct NearestPoints {
  static constexpr std::size_t kMax = 48;  ///< candidates, from which the points of one sheet are chosen
  std::array<std::uint32_t, kMax> points;
  std::array<double, kMax> squared;  ///< distances, model units squared
  std::size_t count = 0;
};
NearestPoints nearestTo(const PointTree& tree, const DVec3& place);

/// Number of neighbours that define a local plane or sphere.
inline constexpr std::size_t kOfAFit = 16;
/// In support radii: points within this distance belong to one sheet.
inline constexpr double kKin = 2;

/// Whether the normal of a point shows which side is outside: in noise it may lie along the plane of its neighbours, or
/// there is no plane. `tree`: of the points.
bool tellsItsSide(const PointCloud& cloud, const PointTree& tree, std::uint32_t point);

/// The normal of a point of the cloud before, rotated as its sheet was bent: the cross product of the transformed
/// tangent directions, from the displacements of its neighbours on the same side. Empty if they were crushed so that
/// they show no direction. `tree`: of the points before. `after[i]` has the number i.
std::optional<DVec3> carriedNormal(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                                   std::uint32_t point);

class EditAftermath {
 public:
  /// `tree`: of the points before. `after[i]` has the number i, the points before first. All arguments must outlive
  /// this.
  EditAftermath(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                const BrushPath& way);

  /// Numbers of the points that are not removed.
  std::span<const std::uint32_t> there() const { return there_; }
  bool isNew(std::uint32_t i) const { return i >= before_.size(); }
  bool moved(std::uint32_t i) const { return !isNew(i) && after_[i].position != before_.positions[i]; }
  DVec3 position(std::uint32_t i) const { return DVec3(after_[i].position); }
  DVec3 normal(std::uint32_t i) const { return DVec3(after_[i].normal); }

  /// Unit direction that the point's sheet faces, derived without the point's own normal if possible, otherwise from
  /// it.
  const DVec3& facing(std::uint32_t i) const { return facings_[i]; }
  /// The point before the edit from which it descends.
  std::uint32_t ancestorOf(std::uint32_t i) const;
  /// Whether two points descend from opposite sides of a part that was thinner than `most`, model units.
  bool wereTwoSides(std::uint32_t i, std::uint32_t k, double most) const;
  /// Distance to the nearest other point that faces the same way, limited to `most`; model units.
  double nearestOfSheet(std::uint32_t i, double most) const;
  /// Normal of the plane through the nearest points of its sheet, unit, of either sign; empty if there are too few, or
  /// if they do not span a plane.
  std::optional<DVec3> fit(std::uint32_t i) const;

 private:
  DVec3 facingOf(std::uint32_t i);
  std::optional<DVec3> wallFacing(std::uint32_t i, std::uint32_t ancestor);
  bool tellsItsSide(std::uint32_t point);
  double sideOf(std::uint32_t point);
  DVec3 nearestCenter(const DVec3& place) const;
  DVec3 placeBefore(std::uint32_t point) const { return DVec3(before_.positions[point]); }
  DVec3 normalBefore(std::uint32_t point) const { return DVec3(before_.normals[point]); }

  const PointCloud& before_;
  const PointTree& treeBefore_;
  std::span<const PointState> after_;
  const BrushPath& way_;
  // Caches for the points before, filled on demand.
  std::vector<std::optional<double>> sides_;
  std::vector<std::optional<bool>> tells_;
  std::vector<DVec3> facings_;  // by number
  std::vector<std::uint32_t> there_;
  std::vector<Vec3> positions_;  // of the points in there_
  std::optional<PointTree> tree_;
};

}  // namespace palpate
