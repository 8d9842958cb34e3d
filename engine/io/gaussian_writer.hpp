// Writing Gaussians as programs that draw splats read them.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// PLY with the properties of 3DGS, of degree 0: for each point a flat Gaussian of its normal and colour (grey where
/// there are none), three quarters of the cloud's mean spacing wide and opaque but for a hundredth. Binary
/// little-endian unless ASCII is asked for. The file appears under its name only when it is whole. Throws FileError,
/// also where there are no normals.
void writeGaussians(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfGaussians(const StoredCloud& stored);

}  // namespace palpate
