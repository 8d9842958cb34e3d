// The Gaussians of a splat scene as points, so that they are selected, cleaned and changed as points are.
#pragma once

#include <span>
#include <vector>

#include "engine/cloud/gaussian_records.hpp"

namespace palpate {

struct GaussianCenters {
  PointCloud cloud;                    ///< their centres and colours; if asked for, all other columns as attributes
  std::vector<std::uint32_t> numbers;  ///< for each point its Gaussian; those without a finite centre are left out
};
GaussianCenters centersOf(const GaussianRecords& records, bool withAttributes, unsigned threads = 0);

/// Gaussians whose centres were prepared: those of `points`, by the index that each had in `centers`, with what differs
/// there, attributes included. Attributes that are new become further columns. If the coordinates were multiplied by a
/// number, the same for all axes, the Gaussians are scaled by it.
std::shared_ptr<const GaussianRecords> changedGaussians(const GaussianRecords& records, const GaussianCenters& centers,
                                                        const PointCloud& points,
                                                        std::span<const std::uint32_t> numbers, unsigned threads = 0);

}  // namespace palpate
