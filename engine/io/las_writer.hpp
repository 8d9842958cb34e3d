// Writing LAS and LAZ.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Writes version 1.2, or 1.4 if attributes need it, or the version of the original file, with its records. Attributes
/// are stored in the LAS fields of their names if they fit, others as extra bytes. The file appears under its name only
/// when it is complete. Throws FileError.
void writeLas(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// The same, compressed: chunks of 50,000 points, a thread each; all chunks are in memory until the file is written.
/// Points with wave packets are rejected.
void writeLaz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfLas(const PointCloud& cloud);
std::vector<const Attribute*> attributesOfLas(const PointCloud& cloud);

}  // namespace palpate
