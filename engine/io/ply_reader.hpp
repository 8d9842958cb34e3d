// Reads PLY files of any encoding, property types, order and extra elements.
#pragma once

#include <filesystem>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/ply_header.hpp"

namespace palpate {

struct PlyReadOptions {
  bool normalsFromFaces = false;  ///< area-weighted from the face element, replacing any in the file
  std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;  ///< receives the triangles of the faces; may be null
  std::vector<std::string>* lost = nullptr;                        ///< receives descriptions of lost rows; may be null
  std::vector<std::uint64_t>* leftOutRows = nullptr;  ///< receives the row numbers that are left out; may be null
  PlyInfo* info = nullptr;  ///< receives the header; if not null, the caller reports which elements are lost
};

/// Reads the vertex element. The whole file is read, so that a truncated one is rejected wherever it ends; bytes after
/// the last element are ignored and logged, as are all losses. Throws FileError with the line (header and ASCII) or
/// byte offset (binary). Memory grows with the bytes present, not with the header's counts.
PointCloud readPly(const std::filesystem::path& path, Log* log = nullptr, PlyReadOptions options = {});

}  // namespace palpate
