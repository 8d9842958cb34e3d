// The Gaussians of a scene whose surface was sculpted, cut or placed elsewhere.
//
// A Gaussian belongs to the nearest point of the surface. Within four spacings of it the Gaussian follows the point:
// moves with it, rotates with the surface around it, is painted with it and removed with it. One that is farther from
// the surface, as sky and haze are, is removed once most points of the surface are that are at most twice as far from
// it as the nearest one, and otherwise stays as it is.
#pragma once

#include <memory>
#include <span>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// What a Gaussian belongs to.
struct GaussianOwner {
  static constexpr std::uint32_t kNone = ~0u;

  std::uint32_t point = kNone;  ///< the nearest one; kNone: the Gaussian's centre is not finite, or there are no points
  double distance = 0;          ///< from it, model units
  bool isNear = false;          ///< it follows the point
  /// Of a near one: another point of the same surface, by which its rotation about the normal is seen; or kNone.
  std::uint32_t beside = kNone;
  std::uint32_t across = kNone;  ///< a third point, not in line with these two: by all three its growth is seen
};
/// Of each Gaussian of `file`, which requires Gaussians. O(N log N).
BareVector<GaussianOwner> gaussianOwners(const PointCloud& file, unsigned threads = 0);

/// The Gaussians of `file` (null: none) with its points in the states `points` (as for editedCloud()): those that stay,
/// in their order, and then those of new points. All that does not change is the same bit by bit; if nothing does, the
/// result is the baggage of `file` itself. A new point has copies of the Gaussians that its ancestor in the file has,
/// or otherwise those of the nearest one; a copy is at most as wide as the spacing of the points. O(N log N) if
/// anything has changed.
std::shared_ptr<const FormatBaggage> editedGaussians(const PointCloud& file, std::span<const PointState> points,
                                                     unsigned threads = 0);

/// The Gaussians of `cloud` with a column of bytes, the last one unless they have it already: those that follow a point
/// have its value, others keep theirs, or have 0. All else is the same bit by bit. O(N log N).
std::shared_ptr<const GaussianRecords> withPointBytes(const PointCloud& cloud, std::string_view name,
                                                      std::span<const std::byte> ofPoints, unsigned threads = 0);
/// Such a column as an attribute of the points, if the Gaussians have it: a point has the largest value of those that
/// follow it, or that of the nearest one.
void addPointBytes(PointCloud& cloud, std::string_view name, unsigned threads = 0);

/// All Gaussians after a rigid motion.
std::shared_ptr<const GaussianRecords> movedGaussians(const GaussianRecords& records, const DQuat& rotation,
                                                      const DVec3& from, const DVec3& to, unsigned threads = 0);

}  // namespace palpate
