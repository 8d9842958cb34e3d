// Clouds that are uneven in the ways in which real ones are, on surfaces that are known: where edits tend to go wrong.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A cloud with exact normals, and a place on it where its unevenness is at its worst.
struct UnevenCloud {
  std::string_view name;
  PointCloud cloud;
  DVec3 place{0};                                      ///< on the surface, model units
  DVec3 normal{0};                                     ///< unit, outward, there
  DVec3 towards{0};                                    ///< unit, in the tangent plane: where a slide goes from there
  std::function<double(const DVec3&)> signedDistance;  ///< to the surface, positive outside; of a plate to its nearer
                                                       ///< sheet
};

/// `even`: a Fibonacci sphere. `gradient`: a sphere whose density falls to a tenth from one side to the other.
/// `patches`: a sphere with twelve dense patches and 8 % of the points in between. `random`: a sphere whose points know
/// nothing of one another. `decimated`: a sphere with the vertices of a decimated mesh: rows far apart of points close
/// together, and clusters. `plate`: two even sheets 0.8 apart that look away from each other.
std::span<const std::string_view> unevenCloudNames();

/// About `count` points; the spheres have the radius 50, the plate the sides 100. The same count gives the same points.
/// Throws UsageError for another name, naming these.
UnevenCloud makeUnevenCloud(std::string_view name, std::size_t count);

/// Two squares of side 100 in the plane of x and y, `thickness` apart, that look away from each other.
PointCloud makePlate(std::size_t count, double thickness, unsigned threads = 0);

}  // namespace palpate
