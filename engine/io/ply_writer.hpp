// Writes PLY files.
#pragma once

#include <filesystem>

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Extra attributes that are not written because the cloud's normals or colours have the same names.
std::vector<std::string> namesGivingWay(const PointCloud& cloud);
/// All other extra attributes.
std::vector<const Attribute*> attributesBeside(const PointCloud& cloud);

/// Whether positions are written in double precision.
bool needsDoubles(const PointCloud& cloud, const CloudWriteOptions& options);

/// Writes x y z [nx ny nz] [red green blue [alpha]] and the extra attributes, in the types that the cloud was stored
/// as, and a face element if there are triangles. Binary little-endian unless ASCII is requested. The file appears
/// under its name only when it is complete. Throws FileError.
void writePly(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options = {});

}  // namespace palpate
