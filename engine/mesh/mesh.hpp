// A mesh on the host, and a check whether it encloses a volume.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct Mesh {
  PointCloud vertices;                                  ///< with normals; colours where the cloud had them
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< anticlockwise as seen from outside
};

/// Topology of a mesh. It is closed if every edge belongs to two triangles that run along it in opposite directions.
struct MeshReport {
  std::uint64_t vertices = 0, triangles = 0, edges = 0;
  std::uint64_t borderEdges = 0;   ///< edges of one triangle
  std::uint64_t crowdedEdges = 0;  ///< edges of more than two triangles
  std::uint64_t turnedEdges = 0;   ///< edges of two triangles that run along it in the same direction
  std::uint64_t unused = 0;        ///< vertices of no triangle
  std::uint64_t flat = 0;          ///< triangles without area in the precision of the vertices
  std::uint64_t parts = 0;         ///< connected by edges
  double area = 0, volume = 0;     ///< model units squared and cubed; the volume is meaningful only for a closed mesh

  bool closed() const { return borderEdges == 0 && crowdedEdges == 0 && turnedEdges == 0; }
  /// Vertices - edges + triangles: for a closed mesh twice the number of parts minus twice the number of handles.
  std::int64_t euler() const {
    return static_cast<std::int64_t>(vertices - unused) - static_cast<std::int64_t>(edges) +
           static_cast<std::int64_t>(triangles);
  }
};
MeshReport examine(const Mesh& mesh);

/// What a file of that name cannot hold of the mesh, in words: "colours".
std::vector<std::string> lostInMeshFile(const std::filesystem::path& file, const Mesh& mesh);

/// Writes vertices (x y z nx ny nz [red green blue]) and faces (a list of three each). Coordinates are doubles if
/// single precision cannot resolve a thousandth of `cell` (of the lattice, model units). The file appears under its
/// name only when it is complete; `keptAs`: see CloudWriteOptions. Throws UsageError for
/// a format that cannot hold triangles, FileError.
void writeMesh(const std::filesystem::path& file, const Mesh& mesh, double cell, bool ascii,
               std::filesystem::path* keptAs = nullptr);

}  // namespace palpate
