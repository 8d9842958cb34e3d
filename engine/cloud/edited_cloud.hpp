// Converts a cloud to the states of its points, and edited states to a cloud that can be written.
#pragma once

#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// The colour of a point as in PointState: red in the lowest byte; 0 if the cloud has no colours.
std::uint32_t packedColor(const PointCloud& cloud, std::size_t point);

/// All points as in the file, by id.
std::vector<PointState> statesOf(const PointCloud& file);

/// Checksum to distinguish clouds: of all properties of the existing points, bit by bit, and of the origin. Removed
/// points do not affect it.
std::uint64_t checksumOf(const DVec3& origin, std::span<const PointState> points);

/// The point of the file from which a point of an edited cloud of `inFile` points has its other properties. Throws
/// Error for a point without.
std::uint64_t ancestorOf(std::span<const PointState> points, std::uint64_t point, std::size_t inFile);

/// Number of `points` that have moved, have another colour, were removed, or are new; `points[i]` has the number i, and
/// the file's points come first.
std::size_t changedPoints(const PointCloud& file, std::span<const PointState> points);

/// The cloud with its points in the states `points` (as for changedPoints()): those of the file that still exist in its
/// order, then the new ones by id. An unmoved point keeps the file's coordinates to the last bit; a new one takes all
/// properties that `points` does not contain from its parent. If the file has no colours and a point was given one, the
/// others get kUnpainted. Gaussians follow their points (editedGaussians()). Throws Error for a point without an
/// ancestor in the file.
PointCloud editedCloud(const PointCloud& file, std::span<const PointState> points);

}  // namespace palpate
