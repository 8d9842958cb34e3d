// Which points of a cloud noise, overlaps and density make superfluous.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/point_set.hpp"

namespace palpate {

// All results are the same with any number of threads (0: one per core). All throw Stopped.

/// Mean distance of each point to its `neighbours` nearest other points, model units; to all others if there are fewer,
/// and 0 if there is none. Points at the same position are neighbours at distance 0.
/// `progress` is called with the share that is done, from any thread.
using ShareDone = std::function<void(double)>;
BareVector<double> neighbourDistances(const PointCloud& cloud, std::uint32_t neighbours, unsigned threads = 0,
                                      const ShareDone& progress = nullptr);

/// A faster neighbourDistances(); empty where it cannot compute them, or would not be faster.
using DistanceMaker = std::function<std::optional<BareVector<double>>(const PointCloud& cloud, std::uint32_t neighbours,
                                                                      unsigned threads)>;

/// The points whose mean distance to their neighbours is more than `sigma` standard deviations above the mean of all
/// (Rusu, Marton, Blodow, Dolha and Beetz 2008, "Towards 3D point cloud based object maps for household environments",
/// section 4.1).
PointSet statisticalOutliers(const PointCloud& cloud, std::uint32_t neighbours, double sigma, unsigned threads = 0,
                             const DistanceMaker& distances = nullptr, const ShareDone& progress = nullptr);

/// What of a cloud statistical outliers are, in words, for a user: "13.9 % of the points"; with the advice to use a
/// larger sigma where these are more than noise usually is.
std::string outlierShare(std::uint64_t outliers, std::uint64_t points);

/// The points with fewer than `neighbours` others nearer than `radius`, model units.
PointSet radiusOutliers(const PointCloud& cloud, std::uint32_t neighbours, double radius, unsigned threads = 0);

/// The points with the coordinates of an earlier point, bit by bit in the file's precision.
PointSet duplicatePoints(const PointCloud& cloud, unsigned threads = 0);

/// One point in each cell of a cubic grid of this side, model units: the one nearest to the middle of its cell, of
/// equals the first. The grid begins at a multiple of the side, whatever the cloud. Throws Error if the cloud is too
/// large for that many cells.
PointSet onePointPerCell(const PointCloud& cloud, double side, unsigned threads = 0);

/// `count` points at random, or all if there are fewer; the same for the same seed.
PointSet randomPoints(std::uint64_t points, std::uint64_t count, std::uint64_t seed);

}  // namespace palpate
