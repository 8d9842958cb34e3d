// Writing triangle meshes: OBJ (Wavefront), STL (3D Systems) and OFF (Geomview).
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// All of them: of the cloud, whose points are the corners of the triangles that the options name. The file appears
/// under its name only when it is whole. Throws FileError, also where there are no triangles.

/// Places, colours and normals as text.
void writeObj(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// Places in single precision and normals of triangles, binary unless ASCII is asked for.
void writeStl(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// Places as text.
void writeOff(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfObj(const StoredCloud& stored);
std::vector<std::string> lacksOfStl(const StoredCloud& stored);
std::vector<std::string> lacksOfOff(const StoredCloud& stored);

}  // namespace palpate
