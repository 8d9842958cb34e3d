// Prepares a scan: selects, cleans, subsamples, sets fields and levels, in one pass of a fixed order.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/select/cleaning.hpp"
#include "engine/select/fields.hpp"
#include "engine/select/preparation.hpp"

namespace palpate {

/// Throws UsageError for corners of a box, as "0,0,0:1,1,1", that are not numbers.
Corners cornersIn(std::string_view text, std::string_view name);
std::string cornersText(const Corners& corners);

/// One step of a preparation that was done.
struct PreparedStep {
  std::string_view name;  ///< path of its setting: "prepare.where"
  std::size_t before = 0, after = 0;
  std::string what;  ///< in words: "keeps 1200 of 5000 points"
};

struct PreparedCloud {
  PointCloud cloud;
  /// For each point the one that it was; new points, which follow all others, have none. Empty if the steps were done
  /// to Gaussians.
  std::vector<std::uint32_t> numbers;
  std::vector<PreparedStep> steps;
  /// Of the whole, where points were removed and nothing was rotated. The cloud then states its axis and touch scale
  /// (keepPose()).
  std::optional<Upright> upright = {};
};

/// Millimetres per unit of a cloud's coordinates: `given` if it is not 0; else the scale that the file states, or that
/// of its unit of length; else its touch scale (touchScaleSaidIn()), or one by which the longest side of
/// coreBoundsOf() is 100 mm.
double mmPerUnit(const PointCloud& cloud, double given);

/// Whether the points of a splat scene's surface are made again after its Gaussians changed. Without, a cloud that was
/// not rotated has its Gaussians alone.
enum class SplatSurface { made, none };

/// In a splat scene the steps are done to the Gaussians, whose columns are fields (`opacity > 0`), and the points are
/// the surface of those that stay; only levelling looks for the ground in the surface, and holes are not closed.
/// `report` is called after each step, and may throw; `distances`: of statisticalOutliers(). Points that stay keep all
/// that no step sets, bit by bit. Throws ExpressionError, Error and Stopped.
PreparedCloud prepared(PointCloud cloud, const Preparation& preparation, const FieldOptions& options,
                       const std::function<void(const PreparedStep&)>& report = {}, const DistanceMaker& distances = {},
                       SplatSurface surface = SplatSurface::made);

}  // namespace palpate
