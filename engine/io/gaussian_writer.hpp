// Writes Gaussians for programs that draw splats.
#pragma once

#include "engine/cloud/gaussian_records.hpp"
#include "engine/io/cloud_format.hpp"

namespace palpate {

/// PLY with the properties of 3DGS, degree 0: for each point a flat Gaussian with its normal and colour (grey if none),
/// a width of three quarters of the cloud's mean spacing and an opacity of 0.99. Binary little-endian unless ASCII is
/// requested. A cloud that was read from Gaussians is written as those, by writeRecords(). The file appears under its
/// name only when it is complete. Throws FileError, also if points have no normals.
void writeGaussians(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

/// PLY with the same properties in the same order and types, and the rows bit by bit; little-endian, or as text.
void writeRecords(const std::filesystem::path& path, const GaussianRecords& records,
                  std::span<const std::string> comments, const CloudWriteOptions& options);

std::vector<std::string> lacksOfGaussians(const PointCloud& cloud);

}  // namespace palpate
