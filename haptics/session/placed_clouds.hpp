// Several clouds in one space, as one cloud.
#pragma once

#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/session/scene.hpp"

namespace palpate {

struct PlacedCloud {
  const PointCloud* cloud = nullptr;
  Placement placement = {};
};

/// All points, cloud after cloud, with their normals and, if any cloud has them, colours; points of the others are
/// kUnpainted. Normals are estimated for each cloud without any, or for all with NormalSource::estimate.
PointCloud mergedCloud(std::span<const PlacedCloud> clouds, NormalSource normals, const ModelLoading& loading);

/// The clouds that the points of a merged cloud come from.
class CloudRows {
 public:
  struct Row {
    std::size_t cloud = 0, row = 0;
    bool isInserted = false;  ///< not of a cloud; `row` is its number among all that were inserted
  };

  CloudRows() = default;
  explicit CloudRows(std::span<const PlacedCloud> clouds);
  /// Rows of a single cloud of this size.
  explicit CloudRows(std::size_t size) : ends_{size} {}
  /// `point`: number of a point; those of the clouds come first.
  Row of(std::size_t point) const;

 private:
  std::vector<std::size_t> ends_;
};

}  // namespace palpate
