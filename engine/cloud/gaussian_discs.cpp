#include "engine/cloud/gaussian_discs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/core/parallel_collect.hpp"

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

}  // namespace palpate
