// Holes of a scanned surface that are closed with new points.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A point to be added to a cloud.
struct NewPoint {
  Vec3 position{0};                     ///< model units, relative to the cloud's origin
  Vec3 normal{0};                       ///< unit
  std::array<std::uint8_t, 4> color{};  ///< RGBA; of no meaning where the cloud has no colours
  std::uint32_t parent = 0;             ///< the point from which it has everything else
};

struct HoleFilling {
  std::vector<NewPoint> points;
  std::size_t closed = 0;  ///< number of holes
  std::size_t left = 0;    ///< others that are no wider, but whose rims fold or overlap
  std::size_t wider = 0;   ///< others that are wider
  double narrowest = 0;    ///< width of the narrowest of these, model units
};

/// Why a splat scene is refused.
inline constexpr std::string_view kGaussiansKeepHoles =
    "the holes of a splat scene cannot be closed, because new points are not Gaussians";

/// "closes 3 holes with 120 new points; 1 hole is wider: 12.5 mm"; lengths are shown as `perUnit` of `unit`.
std::string inWords(const HoleFilling& filling, double perUnit, std::string_view unit = "mm");

/// Points that close the holes which are no wider than `widest`, model units (SurfaceFaces::holes()). A hole is an
/// empty face of SurfaceFaces, so that the outer border of an open scan is none, nor is the gap between two sheets. Its
/// points lie on a ThinPlate over the plane of its rim, through the three rows of points around it; they are spread by
/// Lloyd's relaxation (1982, "Least squares quantization in PCM") at the spacing of these, around any points that are
/// in the hole already. They have the normals of that surface, the colours of the rim by distance, and the nearest
/// point of the rim as parent. Normals of clouds without any are estimated for it. The result does not depend on
/// `threads` (0: one per core). Throws Stopped, and Error for a splat scene.
HoleFilling fillHoles(const PointCloud& cloud, double widest, unsigned threads = 0);

/// Appends points to a cloud. Those that it has do not change.
void addPoints(PointCloud& cloud, const std::vector<NewPoint>& points);

}  // namespace palpate
