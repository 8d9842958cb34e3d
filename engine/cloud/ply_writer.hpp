// Writing PLY files.
#pragma once

#include <array>
#include <filesystem>
#include <functional>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct PlyWriteOptions {
  bool ascii = false;  ///< shortest decimals that read back as the same number
  /// Faces, by the numbers of their points; null: none.
  const std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;
  bool doubles = false;  ///< positions in double precision, whatever the cloud was stored as
  /// An older file of the name is kept, and this is told as what (AtomicFile::commitAndKeep()); null: it is replaced.
  std::filesystem::path* keptAs = nullptr;
  std::function<void(double)> progress = {};  ///< is told the share of the points that is written
};

/// Extra attributes that are not written because the cloud's normals or colours are, under their names.
std::vector<std::string> namesGivingWay(const PointCloud& cloud);

/// Writes x y z [nx ny nz] [red green blue [alpha]] and the extra attributes, in the types that the cloud was stored
/// as, and an element of faces where there are triangles. Binary little-endian unless ASCII is asked for. The file
/// appears under its name only when it is whole. Throws FileError.
void writePly(const std::filesystem::path& path, const PointCloud& cloud, PlyWriteOptions options = {});

}  // namespace palpate
