// The passes of water in double precision.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/render/water_pass.hpp"

namespace palpate::water_test {

inline constexpr double kSpacing = 0.1, kRadius = 0.085, kNone = std::numeric_limits<double>::infinity();

/// One value for each pixel.
struct Surface {
  std::vector<double> depth, thickness, cover;
};

struct Passes {
  Camera camera;
  FrameSize size{};
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> depths;  // per sample, of what is not water
  std::vector<Vec4> lights;           // likewise
  // Results:
  WaterPass::Particles particles{};
  std::vector<std::uint32_t> fronts, sums, surface;
  std::vector<UVec2> smoothed, tidied, shaded;

  std::uint32_t across() const { return size.width * size.supersample; }
  double focal_px() const { return camera.focal_px(size.height); }
  double unitPx(double depth) const { return focal_px() / camera.divisorAt(depth); }
  DVec3 inEye(const DVec3& p) const {
    const Camera::Axes axes = camera.axes();
    const DVec3 off = p - camera.eye;
    return {glm::dot(off, axes.right), glm::dot(off, axes.up), glm::dot(off, axes.forward)};
  }
  struct Ray {
    DVec3 from, along;
  };
  Ray rayOf(double x, double y) const {  // pixels
    const DVec2 off = (DVec2(x, y) - camera.center * DVec2(size.width, size.height)) / focal_px();
    if (camera.isOrthographic()) return {{off.x, -off.y, 0}, {0, 0, 1}};
    return {{0, 0, 0}, {off.x, -off.y, 1}};
  }
  double depthBehind(std::uint32_t x, std::uint32_t y) const {  // samples
    return double{std::bit_cast<float>(depths[y * across() + x])};
  }
};

/// The nearest balls, their thickness in sides of the model, and in place of cover their number.
Surface ballsOf(const Passes& p);
/// One direction of the narrow-range filter.
Surface smoothedAlong(const Passes& p, const Surface& in, bool columns);
/// Averaged over squares.
Surface tidied(const Passes& p, const Surface& in);
DVec3 lightOfWater(const DVec3& body, const DVec3& n, const DVec3& v, double gloss = 1);
/// Light times opacity of a sample, and opacity; from the smoothed surface of the GPU.
DVec4 composed(const Passes& p, const Surface& water, std::uint32_t x, std::uint32_t y);

}  // namespace palpate::water_test
