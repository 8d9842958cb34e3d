// Writing PLY files.
#pragma once

#include <filesystem>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct PlyWriteOptions {
  bool ascii = false;  ///< shortest decimals that read back as the same number
};

/// Writes x y z [nx ny nz] [red green blue [alpha]] and the extra attributes, in the types that the cloud was stored
/// as. Binary little-endian unless ASCII is asked for. The file appears under its name only when it is whole. Throws
/// FileError.
void writePly(const std::filesystem::path& path, const PointCloud& cloud, PlyWriteOptions options = {});

}  // namespace palpate
