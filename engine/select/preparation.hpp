// What is done with the points of a scan before it is used: the settings of prepared_cloud.hpp.
#pragma once

#include <string>
#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/core/setting.hpp"

namespace palpate {

/// The steps, in their order. Those with their initial values are left out.
struct Preparation {
  Corners crop;         ///< keeps the points in the box, its sides included; file coordinates
  Corners cropOutside;  ///< keeps the points outside
  std::string where;    ///< keeps the points for which this expression holds
  bool dropDuplicates = false;
  std::size_t outlierNeighbours = 0;  ///< of statisticalOutliers()
  double outlierSigma = 1;
  std::size_t radiusNeighbours = 0;  ///< of radiusOutliers()
  double radius_mm = 1;
  double fillHoles_mm = 0;  ///< widest opening of fillHoles()
  double subsample_mm = 0;  ///< side of the cells of onePointPerCell()
  std::size_t random = 0;   ///< number of points of randomPoints()
  std::size_t seed = 1;
  std::vector<std::string> set;   ///< rules of applyRule()
  std::optional<UpAxis> upright;  ///< rotates this axis to z
  bool level = false;             ///< rotates the ground to horizontal, with z up

  bool operator==(const Preparation&) const = default;
};

}  // namespace palpate
