#include "engine/cloud/gaussian_density.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/core/parallel_collect.hpp"
#include "engine/core/widest_lanes.hpp"

namespace palpate {

namespace {

constexpr float kFaint = 0.05f;                   // opacity
constexpr float kNotFelt = 0.02f;                 // density below which a Gaussian has no effect
constexpr float kOversized = 10;                  // in usual radii, of the longest deviation
constexpr float kFarthest = 5e5f;                 // in usual radii: single precision resolves a tenth of one there
constexpr float kLargestLog = 60;                 // of deviations: squares of larger ones overflow single precision
constexpr float kThinnest = 0.2f, kThickest = 1;  // usual radii
constexpr double kMaxMeanArea = 2;                // in units of the usual area
constexpr std::size_t kSample = 20'000;

float opacityOf(float logit) { return static_cast<float>(1 / (1 + std::exp(-static_cast<double>(logit)))); }

/// Indices of a Gaussian's longest, middle and shortest axes.
std::array<int, 3> byLength(const Vec3& logScales) {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [&](int a, int b) { return logScales[a] > logScales[b]; });
  return order;
}

enum class Use : std::uint8_t { disc, faint, oversized, outlying };

/// Properties of each Gaussian needed before any can be classified.
struct Size {
  float opacity = 0, logLongest = 0, logRadius = 0;
  Use use = Use::disc;
};

BareVector<Size> sizesOf(const GaussianScene& scene, unsigned threads) {
  return parallelMake(scene.size(), threads, [&](std::size_t i) {
    const Vec3& logs = scene.logScales[i];
    const auto [longest, middle, shortest] = byLength(logs);
    Size size{opacityOf(scene.opacityLogits[i]), logs[longest], 0.5f * (logs[longest] + logs[middle])};
    if (size.opacity < kFaint)
      size.use = Use::faint;
    else if (logs[longest] > kLargestLog || logs[middle] < -kLargestLog)
      size.use = Use::oversized;
    return size;
  });
}

/// Counts in integers, so that the order of summation does not matter.
class RadiusHistogram {
 public:
  void add(const Size& size) { counts_[binOf(size.logRadius)] += static_cast<std::uint64_t>(size.opacity * 65536); }
  void add(const RadiusHistogram& other) {
    for (std::size_t bin = 0; bin < kBins; ++bin) counts_[bin] += other.counts_[bin];
  }
  double median() const {
    std::uint64_t total = 0, below = 0;
    for (const std::uint64_t count : counts_) total += count;
    std::size_t bin = 0;
    while (bin + 1 < kBins && 2 * (below + counts_[bin]) < total) below += counts_[bin++];
    return std::exp((static_cast<double>(bin) + 0.5) / kBinsPerLog - kLargestLog);
  }

 private:
  static constexpr double kBinsPerLog = 64;
  static constexpr auto kBins = static_cast<std::size_t>(2 * kLargestLog * kBinsPerLog);
  static std::size_t binOf(float logRadius) {
    const double bin = (static_cast<double>(logRadius) + kLargestLog) * kBinsPerLog;
    return std::min(static_cast<std::size_t>(std::max(bin, 0.0)), kBins - 1);
  }
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(kBins);
};

double medianRadiusOf(const BareVector<Size>& sizes, unsigned threads) {
  const auto histogramOf = [&](std::size_t begin, std::size_t end) {
    RadiusHistogram histogram;
    for (std::size_t i = begin; i < end; ++i)
      if (sizes[i].use == Use::disc) histogram.add(sizes[i]);
    return histogram;
  };
  const auto join = [](RadiusHistogram a, const RadiusHistogram& b) {
    a.add(b);
    return a;
  };
  return parallelReduce(sizes.size(), threads, RadiusHistogram(), histogramOf, join).median();
}

double usualRadiusOf(const BareVector<Size>& sizes, unsigned threads) {
  const double median = medianRadiusOf(sizes, threads), logMedian = std::log(median);
  struct Share {
    double area, weight;  // in squared medians
  };
  const auto shares = parallelMake(sizes.size(), threads, [&](std::size_t i) {
    const Size& size = sizes[i];
    if (size.use != Use::disc || size.logLongest - logMedian > std::log(kOversized)) return Share{0, 0};
    return Share{size.opacity * std::pow(std::exp(size.logRadius) / median, 2), size.opacity};
  });
  double area = 0, weight = 0;
  for (const Share& share : shares) area += share.area, weight += share.weight;  // in a fixed order, to be reproducible
  return weight > 0 ? median * std::max(1.0, std::sqrt(area / weight / kMaxMeanArea)) : median;
}

/// The median of each coordinate, of a sample.
DVec3 middleOf(const GaussianScene& scene, const BareVector<Size>& sizes) {
  std::array<std::vector<double>, 3> sample;
  const std::size_t step = scene.size() / kSample + 1;
  for (std::size_t i = 0; i < scene.size(); i += step)
    if (sizes[i].use == Use::disc)
      for (int k = 0; k < 3; ++k) sample[static_cast<std::size_t>(k)].push_back(scene.centers[i][k]);
  DVec3 middle(0);
  for (int k = 0; k < 3; ++k) {
    auto& values = sample[static_cast<std::size_t>(k)];
    if (values.empty()) continue;
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, half);
    middle[k] = *half;
  }
  return middle;
}

/// The axes into which a quaternion rotates x, y and z.
std::array<DVec3, 3> axesOf(const Vec4& rotation) {
  const DVec4 q(rotation);
  const double length = glm::length(q);
  if (!(length > 0)) return {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)};
  const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
  return {DVec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
          DVec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
          DVec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
}

GaussianDisc discOf(const GaussianScene& scene, std::size_t i, const Size& size, const GaussianDiscs& frame) {
  const Vec3& logs = scene.logScales[i];
  const auto order = byLength(logs);
  const std::array<DVec3, 3> axes = axesOf(scene.rotations[i]);
  const auto axis = [&](int rank, float most) {
    const int k = order[static_cast<std::size_t>(rank)];
    const double deviation = std::exp(std::max(static_cast<double>(logs[k]), -2.0 * kLargestLog)) / frame.usualRadius;
    return Vec3(axes[static_cast<std::size_t>(k)] * std::clamp<double>(deviation, kThinnest, most));
  };
  GaussianDisc disc{
      .center = Vec3((scene.centers[i] - frame.origin) / frame.usualRadius),
      .opacity = size.opacity,
      .longest = axis(0, kOversized),
      .middle = axis(1, kOversized),
      .shortest = axis(2, kThickest),
      .color = glm::clamp(0.5f + static_cast<float>(kZeroHarmonic) * scene.colorHarmonics[i], 0.0f, 1.0f)};
  const float deviations = std::sqrt(2 * std::log(disc.opacity / kNotFelt));
  disc.reach =
      deviations * glm::sqrt(disc.longest * disc.longest + disc.middle * disc.middle + disc.shortest * disc.shortest);
  return disc;
}

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

float GaussianDisc::area() const { return std::numbers::pi_v<float> * glm::length(longest) * glm::length(middle); }

GaussianDiscs discsOf(const GaussianScene& scene, unsigned threads) {
  GaussianDiscs made;
  BareVector<Size> sizes = sizesOf(scene, threads);
  made.usualRadius = usualRadiusOf(sizes, threads);
  made.origin = middleOf(scene, sizes);
  const double logOversized = std::log(kOversized * made.usualRadius);
  parallelFor(sizes.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Use& use = sizes[i].use;
      const DVec3 far = glm::abs(scene.centers[i] - made.origin) / made.usualRadius;
      if (use == Use::disc && sizes[i].logLongest > logOversized) use = Use::oversized;
      if (use == Use::disc && !(std::max({far.x, far.y, far.z}) < kFarthest)) use = Use::outlying;
    }
  });
  const auto countOf = [&](Use use) {
    return parallelCount(sizes.size(), threads, [&](std::size_t i) { return sizes[i].use == use; });
  };
  made.faint = countOf(Use::faint), made.oversized = countOf(Use::oversized), made.outlying = countOf(Use::outlying);
  made.discs = parallelCollect(
      sizes.size(), threads, [&](std::size_t i) { return sizes[i].use == Use::disc; },
      [&](std::size_t i) { return discOf(scene, i, sizes[i], made); });
  return made;
}

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
