// Reading PLY files of any encoding, property types, order and extra elements.
#pragma once

#include <filesystem>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/ply_header.hpp"

namespace palpate {

struct PlyReadOptions {
  bool normalsFromFaces = false;  ///< area-weighted from the face element, in place of any that the file gives
  std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;  ///< where to put those of the faces, if anywhere
  std::vector<std::string>* lost = nullptr;           ///< where to put in words what rows are lost, if anywhere
  std::vector<std::uint64_t>* leftOutRows = nullptr;  ///< where to put the numbers of those that are no points
  PlyInfo* info = nullptr;  ///< where to put the header, if anywhere; who takes it says itself which elements are lost
};

/// Reads the vertex element. The whole file is walked, so a truncated one is refused wherever it ends; bytes after the
/// last element are ignored and said through `log`, as is everything that is lost. Throws FileError with the line
/// (header and ASCII) or byte offset (binary). Memory follows the bytes that are really there, not the header's counts.
PointCloud readPly(const std::filesystem::path& path, Log* log = nullptr, PlyReadOptions options = {});

}  // namespace palpate
