// Coordinates as in the file, where it has more digits than single precision.
#pragma once

#include <optional>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Whether PointCloud::fileCoordinates() are more precise than single precision.
inline bool isExact(const PointCloud& cloud) { return !cloud.exactPositions.empty() || cloud.storedAs.grid; }

/// The box around these coordinates. All zero for an empty cloud.
Bounds fileBoundsOf(const PointCloud& cloud);

/// The positions of a CoordinateGrid, each the double next to its decimal if step and offset are decimals, as 0.01 and
/// 637000.5: 849393.95, and not 849393.9500000001 like k * step + offset in double precision.
class DecimalGrid {
 public:
  explicit DecimalGrid(const CoordinateGrid& grid);
  /// `k`: whole numbers.
  DVec3 at(const DVec3& k) const;
  /// The grid with a tenth of the step, which contains these positions bit by bit; empty if they are not decimals, or
  /// have too many digits.
  std::optional<CoordinateGrid> tenths() const;

 private:
  CoordinateGrid grid_;
  DVec3 parts_{0};  ///< of a unit, of which step and offset are whole numbers: a power of ten; 0: they are not decimals
};

}  // namespace palpate
