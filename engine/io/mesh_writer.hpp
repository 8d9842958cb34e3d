// Writes triangle meshes: OBJ (Wavefront), STL (3D Systems) and OFF (Geomview).
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// All functions write the triangles given in the options, whose corners are the points of the cloud. The file appears
/// under its name only when it is complete. They throw FileError, also without triangles.

/// Writes positions, colours and normals as text.
void writeObj(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// Writes positions in single precision and normals of triangles, binary unless ASCII is requested.
void writeStl(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// Writes positions as text.
void writeOff(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfObj(const PointCloud& cloud);
std::vector<std::string> lacksOfStl(const PointCloud& cloud);
std::vector<std::string> lacksOfOff(const PointCloud& cloud);

}  // namespace palpate
