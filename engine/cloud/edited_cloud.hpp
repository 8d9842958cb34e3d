// An edited cloud, point by point, and back as a cloud that can be written.
#pragma once

#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// The colour of a point as PointState has it: red in the lowest byte; 0 where the cloud has no colours.
std::uint32_t packedColor(const PointCloud& cloud, std::size_t point);

/// All points as the file had them, by id.
std::vector<PointState> statesOf(const PointCloud& file);

/// Tells clouds apart: of all that the points which are there are, bit by bit, and of the origin. Points that are not
/// there change nothing.
std::uint64_t checksumOf(const DVec3& origin, std::span<const PointState> points);

/// How many of `points` stand elsewhere than in the file or have another colour, are gone, or are new; `points[i]` has
/// the number i, and the file's come first.
std::size_t changedPoints(const PointCloud& file, std::span<const PointState> points);

/// The cloud with its points as `points` say (as for changedPoints()): those of the file that are still there in its
/// order, then the new ones by id. A point that has not moved keeps the file's coordinates to the last bit, a new one
/// has all that `points` does not say from its parent. Where the file has no colours and a point was given one, the
/// others get kUnpainted. Throws Error for a point without an ancestor in the file.
PointCloud editedCloud(const PointCloud& file, std::span<const PointState> points);

}  // namespace palpate
