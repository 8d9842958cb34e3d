// Coordinates as in the file, where it has more digits than single precision.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Whether PointCloud::fileCoordinates() are more precise than single precision.
inline bool isExact(const PointCloud& cloud) { return !cloud.exactPositions.empty() || cloud.storedAs.grid; }

/// The box around these coordinates. All zero for an empty cloud.
Bounds fileBoundsOf(const PointCloud& cloud);

/// Coordinates of a cloud for tables of text. Those on its CoordinateGrid are the doubles next to their decimals if
/// step and offset are decimals, as 0.01 and 637000.5: 849393.95, and not 849393.9500000001 like k * step + offset in
/// double precision.
class TextCoordinates {
 public:
  explicit TextCoordinates(const PointCloud& cloud);
  DVec3 at(std::size_t i) const;

 private:
  const PointCloud& cloud_;
  DVec3 parts_{0};  ///< of a unit, of which step and offset are whole numbers: a power of ten; 0: they are not decimals
};

}  // namespace palpate
