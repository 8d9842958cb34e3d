#include "engine/cloud/gaussian_density.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace palpate {

namespace {

/// e^-x for x >= 0 to 2e-5 of itself, e^-40 from there on: without a branch, a call or a comparison of floats, so that
/// compilers let lanes go together.
inline float fallingExp(float x) {
  constexpr float kLog2E = 1.44269504f, kLn2 = 0.69314718f, kMost = 40;
  // Positive numbers are in the order of their bits.
  const float most = std::bit_cast<float>(std::min(std::bit_cast<std::int32_t>(x), std::bit_cast<std::int32_t>(kMost)));
  const float power = -kLog2E * most;
  const auto whole = static_cast<std::int32_t>(power);  // towards zero, so that the rest is in (-1, 0]
  const float y = (power - static_cast<float>(whole)) * kLn2;
  const float series =
      1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120 + y * (1.0f / 720))))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

template <class Lanes>
float sum(const Lanes& lanes) {
  float total = 0;
  for (const float lane : lanes) total += lane;
  return total;
}

}  // namespace

/// What a block of Gaussians makes of a place: their densities there, and their precision times the way from their
/// centres.
struct GaussianDensity::Felt {
  Lanes density, x, y, z;
};

template <class Use>
inline void GaussianDensity::forEach(const Vec3& p, Use&& use) const {
  for (const Block& block : blocks_) {
    const auto& c = block.columns;
    Felt felt;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float x = p.x - c[kX][k], y = p.y - c[kY][k], z = p.z - c[kZ][k];
      felt.x[k] = c[kXX][k] * x + c[kXY][k] * y + c[kXZ][k] * z;
      felt.y[k] = c[kXY][k] * x + c[kYY][k] * y + c[kYZ][k] * z;
      felt.z[k] = c[kXZ][k] * x + c[kYZ][k] * y + c[kZZ][k] * z;
      const float squared = x * felt.x[k] + y * felt.y[k] + z * felt.z[k];
      felt.density[k] = c[kOpacity][k] * fallingExp(0.5f * squared);
    }
    use(block, felt);
  }
}

void GaussianDensity::clear() {
  blocks_.clear();
  count_ = 0;
}

void GaussianDensity::add(const GaussianDisc& disc) {
  if (count_ % kLanes == 0) blocks_.push_back({});
  auto& c = blocks_.back().columns;
  const std::size_t k = count_++ % kLanes;
  for (int i = 0; i < 3; ++i) {
    c[kX + static_cast<std::size_t>(i)][k] = disc.center[i];
    c[kRed + static_cast<std::size_t>(i)][k] = disc.color[i];
  }
  c[kOpacity][k] = disc.opacity;
  for (const Vec3& axis : {disc.longest, disc.middle, disc.shortest}) {
    const float square = glm::dot(axis, axis), weight = 1 / (square * square);
    c[kXX][k] += weight * axis.x * axis.x, c[kYY][k] += weight * axis.y * axis.y, c[kZZ][k] += weight * axis.z * axis.z;
    c[kXY][k] += weight * axis.x * axis.y, c[kXZ][k] += weight * axis.x * axis.z, c[kYZ][k] += weight * axis.y * axis.z;
  }
}

GaussianDensity::Slope GaussianDensity::slopeAt(const Vec3& p) const {
  Lanes density{}, x{}, y{}, z{};
  forEach(p, [&](const Block&, const Felt& felt) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      density[k] += felt.density[k];
      x[k] -= felt.density[k] * felt.x[k];
      y[k] -= felt.density[k] * felt.y[k];
      z[k] -= felt.density[k] * felt.z[k];
    }
  });
  return {sum(density), {sum(x), sum(y), sum(z)}};
}

GaussianDensity::Curvature GaussianDensity::curvatureAt(const Vec3& p) const {
  Lanes density{};
  std::array<Lanes, 3> slope{};
  std::array<Lanes, 6> bend{};  // of the density itself, with the sign changed
  forEach(p, [&](const Block& block, const Felt& felt) {
    const auto& c = block.columns;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float w = felt.density[k], x = felt.x[k], y = felt.y[k], z = felt.z[k];
      density[k] += w;
      slope[0][k] -= w * x, slope[1][k] -= w * y, slope[2][k] -= w * z;
      bend[0][k] += w * (c[kXX][k] - x * x), bend[1][k] += w * (c[kYY][k] - y * y);
      bend[2][k] += w * (c[kZZ][k] - z * z), bend[3][k] += w * (c[kXY][k] - x * y);
      bend[4][k] += w * (c[kXZ][k] - x * z), bend[5][k] += w * (c[kYZ][k] - y * z);
    }
  });
  const float total = sum(density);
  Curvature found{.density = total,
                  .logGradient = Vec3(sum(slope[0]), sum(slope[1]), sum(slope[2])) / total,
                  .downwards = {.xx = sum(bend[0]) / total,
                                .yy = sum(bend[1]) / total,
                                .zz = sum(bend[2]) / total,
                                .xy = sum(bend[3]) / total,
                                .xz = sum(bend[4]) / total,
                                .yz = sum(bend[5]) / total}};
  found.downwards.addSquare(DVec3(found.logGradient));
  return found;
}

GaussianDensity::Behind GaussianDensity::behind(const Vec3& p, const Vec3& n) const {
  Lanes density{}, off{}, thin{}, red{}, green{}, blue{};
  forEach(p, [&](const Block& block, const Felt& felt) {
    const auto& c = block.columns;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float w = felt.density[k];
      density[k] += w;
      off[k] += w * (n.x * felt.x[k] + n.y * felt.y[k] + n.z * felt.z[k]);
      thin[k] += w * (n.x * n.x * c[kXX][k] + n.y * n.y * c[kYY][k] + n.z * n.z * c[kZZ][k] +
                      2 * (n.x * n.y * c[kXY][k] + n.x * n.z * c[kXZ][k] + n.y * n.z * c[kYZ][k]));
      red[k] += w * c[kRed][k];
      green[k] += w * c[kGreen][k];
      blue[k] += w * c[kBlue][k];
    }
  });
  return {sum(off) / sum(thin), Vec3(sum(red), sum(green), sum(blue)) / sum(density)};
}

}  // namespace palpate
