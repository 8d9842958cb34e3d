// The points of a cloud while it is sculpted on the CPU: points are inserted and removed, each keeps its number.
#pragma once

#include <limits>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// One entry in every array for each point that exists or was removed: the file's in its order, then new ones.
struct SculptedPoints {
  std::vector<Vec3> positions;         ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;           ///< unit
  std::vector<std::uint32_t> colors;   ///< RGBA8; 0 if the cloud has no colours
  std::vector<std::uint32_t> parents;  ///< the point of the file from which the other properties are taken
  std::vector<std::uint8_t> there;     ///< 0: the point is removed
  /// Nonzero: the point has moved, is new, or has a pending request; the next tick examines it.
  std::vector<std::uint8_t> unsettled;
  /// Spacing around each point of the file as loaded, which edits maintain; model units. Empty if not needed.
  std::vector<float> spacings;
  /// Position of a point in the cloud as loaded; of a new point, half way between those of the ends of its gap. A point
  /// that is set without ends rests at its first position. Model units, relative to the cloud's origin.
  std::vector<Vec3> rests;
  /// For each new point, the maximum distance of further points inserted because of it, model units.
  std::vector<float> reaches;

  /// State in which a stroke found a point.
  struct FoundState {
    Vec3 position{0}, normal{0};
    float room = shared::kUnseen;  ///< how far it may go on; while carved: from there to the far sheet; model units
  };
  /// The same with the number of the stroke; 0: none.
  struct Found : FoundState {
    std::uint32_t stroke = 0;
  };
  std::vector<FoundState> founds;      ///< of the last stroke that changed the point
  std::vector<std::uint32_t> strokes;  ///< its number, or 0; apart, since most points under a brush are unchanged

  /// Number of points of the file; these have the smaller numbers.
  std::uint32_t fromFile = 0;

  /// `cloud` must have normals. Spacings are left empty.
  explicit SculptedPoints(const PointCloud& cloud);
  /// Number of points including removed ones.
  std::size_t size() const { return positions.size(); }
  /// The target spacing for a point and its surroundings, model units.
  double spacing(std::uint32_t point) const { return double{spacings[parents[point]]}; }

  /// State in which a stroke has found a point.
  Found found(std::uint32_t point, std::uint32_t stroke) const {
    if (strokes[point] == stroke) return lastFound(point);
    return {{positions[point], normals[point]}, stroke};
  }
  /// State in which the last stroke to change it found it.
  Found lastFound(std::uint32_t point) const { return {founds[point], strokes[point]}; }
  void setFound(std::uint32_t point, const Found& found) {
    founds[point] = found;
    strokes[point] = found.stroke;
  }

  /// Fetches what a brush reads of a point into the cache.
  void prefetch(std::uint32_t point) const {
    __builtin_prefetch(&positions[point]);
    __builtin_prefetch(&parents[point]);
    prefetchNormal(point);
  }
  void prefetchSpacing(std::uint32_t point) const {
    if (!spacings.empty()) __builtin_prefetch(&spacings[parents[point]]);
  }
  void prefetchNormal(std::uint32_t point) const {
    __builtin_prefetch(&normals[point]);
    __builtin_prefetch(&strokes[point]);
  }
  void prefetchFound(std::uint32_t point, std::uint32_t stroke) const {
    if (strokes[point] == stroke) __builtin_prefetch(&founds[point]);
  }

  PointState state(std::uint32_t point) const;
  /// Sets a point, which is then settled; extends the arrays for a new one. Its parent must be one of the file's
  /// points.
  void set(const PointState& state);
  /// Adds a point at `position`, with the mean of the normals, colours, rests and found states of two points; the first
  /// of them requested it. `parent`: the one of the two whose parent it gets. Returns its number.
  std::uint32_t insertBetween(std::uint32_t point, std::uint32_t other, std::uint32_t parent, const Vec3& position);
};

}  // namespace palpate
