// Prepares a scan: selects, cleans, subsamples, sets fields and levels, in one pass of a fixed order.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/setting.hpp"
#include "engine/select/fields.hpp"

namespace palpate {

/// The steps, in their order. Those with their initial values are left out.
struct Preparation {
  Corners crop;             ///< keeps the points in the box, its sides included; file coordinates
  Corners cropOutside;      ///< keeps the points outside
  std::string where;        ///< keeps the points for which this expression holds
  bool dropDuplicates = false;
  std::size_t outlierNeighbours = 0;  ///< of statisticalOutliers()
  double outlierSigma = 1;
  std::size_t radiusNeighbours = 0;   ///< of radiusOutliers()
  double radius_mm = 1;
  double subsample_mm = 0;            ///< side of the cells of onePointPerCell()
  std::size_t random = 0;             ///< number of points of randomPoints()
  std::size_t seed = 1;
  std::vector<std::string> set;       ///< rules of applyRule()
  bool level = false;                 ///< rotates the ground to horizontal, with z up

  bool operator==(const Preparation&) const = default;
};

/// Throws UsageError for corners of a box, as "0,0,0:1,1,1", that are not numbers.
Corners cornersIn(std::string_view text, std::string_view name);
std::string cornersText(const Corners& corners);

/// One step of a preparation that was done.
struct PreparedStep {
  std::string_view option;  ///< as on the command line: "--where"
  std::size_t before = 0, after = 0;
  std::string what;  ///< in words: "keeps 1200 of 5000 points"
};

struct PreparedCloud {
  PointCloud cloud;
  std::vector<std::uint32_t> numbers;  ///< for each point the one that it was
  std::vector<PreparedStep> steps;
};

/// Millimetres per unit of a cloud's coordinates: `given` if it is not 0; else the scale that the file states, or that
/// of its unit of length; else the touch scale, by which the longest side of coreBoundsOf() is 100 mm.
double mmPerUnit(const PointCloud& cloud, double given);

/// `report` is called after each step, and may throw. Points that stay keep all that no step sets, bit by bit. Throws
/// ExpressionError, Error and Stopped.
PreparedCloud prepared(PointCloud cloud, const Preparation& preparation, const FieldOptions& options,
                       const std::function<void(const PreparedStep&)>& report = {});

}  // namespace palpate
