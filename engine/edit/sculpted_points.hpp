// The points of a cloud while it is sculpted on the CPU: they come and go, each keeps its number.
#pragma once

#include <limits>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// One entry in every array per point that is or was there: the file's in its order, then those that came later.
struct SculptedPoints {
  std::vector<Vec3> positions;         ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;           ///< unit
  std::vector<std::uint32_t> colors;   ///< RGBA8; 0 where the cloud has none
  std::vector<std::uint32_t> parents;  ///< the point of the file that the other properties come from
  std::vector<std::uint8_t> there;     ///< 0: the point is gone
  /// Not 0: the point has moved, is new, or has not got what it requested; the next tick examines it.
  std::vector<std::uint8_t> unsettled;
  /// Of the points of the file: how far apart they and their neighbours were, which is what edits keep to; model units.
  /// Empty where nobody asks.
  std::vector<float> spacings;
  /// Where a point stood in the cloud as loaded; of a new one, half way between where its ends did. One that is set
  /// without ends rests where it is set first. Model units, relative to the cloud's origin.
  std::vector<Vec3> rests;
  /// Of the points that came later: how far from there others may come because of it, model units.
  std::vector<float> reaches;

  /// A point as the stroke found it that changed it last.
  struct Found {
    Vec3 position{0}, normal{0};
    std::uint32_t stroke = 0;
    float thick = 3.0e38f;  ///< how far under it the far sheet was seen last, model units
  };
  std::vector<Found> founds;

  /// Points of the file: those with smaller numbers.
  std::uint32_t fromFile = 0;

  /// `cloud` must have normals. Spacings are left empty.
  explicit SculptedPoints(const PointCloud& cloud);
  /// Points that are or were there.
  std::size_t size() const { return positions.size(); }
  /// The target for a point and those around it, model units.
  double spacing(std::uint32_t point) const { return double{spacings[parents[point]]}; }

  /// A point as a stroke has found it.
  Found found(std::uint32_t point, std::uint32_t stroke) const {
    if (founds[point].stroke == stroke) return founds[point];
    return {positions[point], normals[point], stroke};
  }

  PointState state(std::uint32_t point) const;
  /// Sets a point, which is settled then; makes room where it is new. Its parent must be one of the file's points.
  void set(const PointState& state);
  /// Adds a point at `position`, with the middle of the normals, colours and rests of two points, and of them as a
  /// stroke found them; the first of them asked for it. `parent`: whose parent it gets, one of the two. Gives its
  /// number.
  std::uint32_t insertBetween(std::uint32_t point, std::uint32_t other, std::uint32_t parent, const Vec3& position);
};

}  // namespace palpate
