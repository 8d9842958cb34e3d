// Writing LAS and LAZ.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Version 1.2, or 1.4 where attributes need it, or that of the file that the cloud came from, with its records.
/// Attributes that LAS has by name go there where they fit, others become extra bytes. The file appears under its name
/// only when it is whole. Throws FileError.
void writeLas(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);
/// The same, packed: chunks of 50,000 points, a thread each; all of them are in memory until the file is written.
/// Points with wave packets are refused.
void writeLaz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options);

std::vector<std::string> lacksOfLas(const StoredCloud& stored);

}  // namespace palpate
