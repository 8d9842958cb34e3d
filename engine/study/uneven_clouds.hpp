// Clouds that are uneven in the ways of real scans, on known surfaces: test cases in which edits tend to go wrong.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A cloud with exact normals, and the position on it where it is most uneven.
struct UnevenCloud {
  std::string_view name;
  PointCloud cloud;
  DVec3 place{0};                                      ///< on the surface, model units
  DVec3 normal{0};                                     ///< unit, outward, at that position
  DVec3 towards{0};                                    ///< unit, in the tangent plane: direction of a slide from there
  std::function<double(const DVec3&)> signedDistance;  ///< positive outside; for a plate, to its nearer sheet
};

/// `even`: a Fibonacci sphere. `gradient`: a sphere whose density falls to a tenth from one side to the other.
/// `patches`: a sphere with twelve dense patches and 8 % of the points in between. `random`: a sphere of independent
/// random points. `decimated`: a sphere with the vertices of a decimated mesh: rows far apart of points close together,
/// and clusters. `plate`: two even sheets 0.8 apart that face away from each other.
std::span<const std::string_view> unevenCloudNames();

/// About `count` points; the spheres have the radius 50, the plate the side 100. The same count gives the same points.
/// Throws UsageError for another name, listing these.
UnevenCloud makeUnevenCloud(std::string_view name, std::size_t count);

/// Two squares of side 100 parallel to the x-y plane, `thickness` apart, that face away from each other.
PointCloud makePlate(std::size_t count, double thickness, unsigned threads = 0);

}  // namespace palpate
