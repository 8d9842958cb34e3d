#include "engine/cloud/gaussian_density.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/core/widest_lanes.hpp"

namespace palpate {

namespace {

/// e^(-x / 2) for x >= 0 with a relative error of 4e-6, e^-40 from 80 on: without branches, calls or comparisons of
/// floats, so that compilers vectorise it.
PALPATE_INTO_CALLER inline float fallingExp(float x) {
  constexpr float kHalfLog2E = 0.72134752f, kMax = 80;
  constexpr float kWhole =
      12582912 + 127;  // floats of this magnitude are integers; their last bits become the exponent
  // Positive floats are ordered like their bits.
  const float most = std::bit_cast<float>(std::min(std::bit_cast<std::int32_t>(x), std::bit_cast<std::int32_t>(kMax)));
  const float power = -kHalfLog2E * most, shifted = power + kWhole;
  const float y = power - (shifted - kWhole);  // in [-0.5, 0.5]
  const float series = 1 + y * (0.693124193f + y * (0.240240986f + y * (0.055906425f + y * 0.009582853f)));
  return series * std::bit_cast<float>(std::bit_cast<std::int32_t>(shifted) << 23);
}

/// Pairwise, so that the order does not depend on the vector width.
template <std::size_t kCount>
PALPATE_INTO_CALLER inline float sum(const std::array<float, kCount>& lanes) {
  if constexpr (kCount == 1) {
    return lanes[0];
  } else {
    std::array<float, kCount / 2> halves;
    for (std::size_t k = 0; k < kCount / 2; ++k) halves[k] = lanes[k] + lanes[k + kCount / 2];
    return sum(halves);
  }
}

}  // namespace

FeltGaussian::FeltGaussian(const GaussianDisc& disc)
    : center(disc.center), opacity(disc.opacity), color(disc.color), reach(disc.reach) {
  for (const Vec3& axis : {disc.longest, disc.middle, disc.shortest}) {
    const float square = glm::dot(axis, axis), weight = 1 / (square * square);
    xx += weight * axis.x * axis.x, yy += weight * axis.y * axis.y, zz += weight * axis.z * axis.z;
    xy += weight * axis.x * axis.y, xz += weight * axis.x * axis.z, yz += weight * axis.y * axis.z;
  }
}

/// Contribution of a block of Gaussians at a position: their densities there, and their precision matrices times the
/// offsets from their centres.
struct GaussianDensity::Felt {
  Lanes density, x, y, z;
};

template <class Use>
PALPATE_INTO_CALLER inline void GaussianDensity::forEach(const Vec3& p, Use&& use) const {
  for (const Block& block : blocks_) {
    const auto& c = block.columns;
    Felt felt;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float x = p.x - c[kX][k], y = p.y - c[kY][k], z = p.z - c[kZ][k];
      felt.x[k] = c[kXX][k] * x + c[kXY][k] * y + c[kXZ][k] * z;
      felt.y[k] = c[kXY][k] * x + c[kYY][k] * y + c[kYZ][k] * z;
      felt.z[k] = c[kXZ][k] * x + c[kYZ][k] * y + c[kZZ][k] * z;
      const float squared = x * felt.x[k] + y * felt.y[k] + z * felt.z[k];
      felt.density[k] = c[kOpacity][k] * fallingExp(squared);
    }
    use(block, felt);
  }
}

void GaussianDensity::fill(std::span<const FeltGaussian> gaussians, std::span<const std::uint32_t> chosen) {
  blocks_.resize((chosen.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const FeltGaussian& g = gaussians[chosen[i]];
    auto& c = blocks_[i / kLanes].columns;
    const std::size_t k = i % kLanes;
    c[kX][k] = g.center.x, c[kY][k] = g.center.y, c[kZ][k] = g.center.z;
    c[kOpacity][k] = g.opacity;
    c[kXX][k] = g.xx, c[kYY][k] = g.yy, c[kZZ][k] = g.zz;
    c[kXY][k] = g.xy, c[kXZ][k] = g.xz, c[kYZ][k] = g.yz;
    c[kRed][k] = g.color.x, c[kGreen][k] = g.color.y, c[kBlue][k] = g.color.z;
  }
  if (const std::size_t used = chosen.size() % kLanes; used != 0)
    for (Lanes& column : blocks_.back().columns) std::fill(column.begin() + used, column.end(), 0.0f);
}

PALPATE_WIDEST_LANES float GaussianDensity::densityAt(const Vec3& p) const {
  Lanes density{};
  forEach(p, [&](const Block&, const Felt& felt) PALPATE_INTO_CALLER {
    for (std::size_t k = 0; k < kLanes; ++k) density[k] += felt.density[k];
  });
  return sum(density);
}

PALPATE_WIDEST_LANES GaussianDensity::Slope GaussianDensity::slopeAt(const Vec3& p) const {
  Lanes density{}, x{}, y{}, z{};
  forEach(p, [&](const Block&, const Felt& felt) PALPATE_INTO_CALLER {
    for (std::size_t k = 0; k < kLanes; ++k) {
      density[k] += felt.density[k];
      x[k] -= felt.density[k] * felt.x[k];
      y[k] -= felt.density[k] * felt.y[k];
      z[k] -= felt.density[k] * felt.z[k];
    }
  });
  return {sum(density), {sum(x), sum(y), sum(z)}};
}

PALPATE_WIDEST_LANES GaussianDensity::Curvature GaussianDensity::curvatureAt(const Vec3& p) const {
  Lanes density{};
  std::array<Lanes, 3> slope{};
  std::array<Lanes, 6> bend{};  // negated second derivatives of the density
  forEach(p, [&](const Block& block, const Felt& felt) PALPATE_INTO_CALLER {
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

PALPATE_WIDEST_LANES GaussianDensity::Behind GaussianDensity::behind(const Vec3& p, const Vec3& n) const {
  Lanes density{}, off{}, thin{}, red{}, green{}, blue{};
  forEach(p, [&](const Block& block, const Felt& felt) PALPATE_INTO_CALLER {
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
