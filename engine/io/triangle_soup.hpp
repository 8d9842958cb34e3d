// Triangles as files of meshes hold them, and points that are sampled from them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Corners by number; normals and colours of corners where all have them, else empty. Nothing is said of how triangles
/// hang together.
struct TriangleSoup {
  std::vector<DVec3> corners;
  std::vector<Vec3> normals;                        ///< of any length
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< RGBA
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// How many of each are gone.
struct BadCorners {
  std::size_t corners = 0, triangles = 0;
};
/// Takes corners away that are not at finite numbers below 1e30, with their triangles.
BadCorners leaveOutBadCorners(TriangleSoup& soup);

struct SampledSoup {
  PointCloud cloud;      ///< with normals, and colours where the corners have some
  std::size_t flat = 0;  ///< triangles that are left out, as they have no area
};

/// `count` points, spread evenly by area: the same number to equal areas but for one, in order of the triangles, and
/// within each by a sequence that leaves no gaps (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences", after Weyl 1916), which `seed` turns. Normals are those of the corners, blended, or else of the
/// triangle, whose corners are anticlockwise seen from outside. The same for any number of threads (0: one per core).
/// No points where no triangle has an area.
SampledSoup sampleSoup(const TriangleSoup& soup, std::size_t count, std::uint64_t seed, unsigned threads = 0);

}  // namespace palpate
