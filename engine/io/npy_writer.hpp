// Writes arrays as NumPy does: one with named columns (NPY), or one for each attribute (NPZ).
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A structured array: x y z, nx ny nz, red green blue [alpha] and the other attributes under their names. The file
/// appears under its name only when it is complete. Throws FileError.
void writeNpy(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

/// Like numpy.savez_compressed: `xyz` of shape (N, 3), in double precision if the cloud has it; `normals`, (N, 3),
/// float32; `colors`, (N, 3), uint8; and the other attributes, (N,), under their names. Each array is built in memory.
void writeNpz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfNpy(const PointCloud& cloud);
std::vector<std::string> lacksOfNpz(const PointCloud& cloud);

}  // namespace palpate
