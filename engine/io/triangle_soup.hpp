// Triangles of mesh files, and sampling of points from them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

/// Triangles index corners; normals and colours are per corner if all corners have them, else empty. No connectivity.
struct TriangleSoup {
  struct TexturedCorners {
    std::uint32_t texture = kNoTexture;
    std::array<Vec2, 3> uv{};  ///< as in TextureSpot
  };

  std::vector<DVec3> corners;
  std::vector<Vec3> normals;                        ///< of any length
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< RGBA
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Texture> textures;          ///< multiply the colours, or white
  std::vector<TexturedCorners> textured;  ///< by triangle, if there are textures
};

/// Number of each that were removed.
struct BadCorners {
  std::size_t corners = 0, triangles = 0;
};
/// Removes corners without finite coordinates below 1e30, and their triangles.
BadCorners leaveOutBadCorners(TriangleSoup& soup);

/// Multiplies the colours of corners by the textures. A corner at which triangles have different colours becomes
/// several. Returns the textures that could not be read; if no texture could be, and corners had no colours, they still
/// have none.
std::vector<std::string> colorCorners(TriangleSoup& soup);

struct SampledSoup {
  PointCloud cloud;               ///< with normals, and colours if the corners or their textures have them
  std::size_t flat = 0;           ///< triangles left out because they have no area
  std::vector<std::string> lost;  ///< textures that could not be read
};

/// Samples `count` points, distributed evenly by area: equal areas have the same number of points (differing by at most
/// one), in the order of triangles, and within each triangle a low-discrepancy sequence (Roberts 2018, "The
/// unreasonable effectiveness of quasirandom sequences", after Weyl 1916), shifted by `seed`. Normals are interpolated
/// from the corners, or else those of the triangle, whose corners are anticlockwise seen from outside. Independent of
/// the number of threads (0: one per core). No points if no triangle has an area.
SampledSoup sampleSoup(const TriangleSoup& soup, std::size_t count, std::uint64_t seed, unsigned threads = 0);

}  // namespace palpate
