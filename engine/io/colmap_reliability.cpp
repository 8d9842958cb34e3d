#include "engine/io/colmap_reliability.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace palpate {

namespace {

constexpr std::size_t kMinViews = 3;
constexpr double kMaxError_px = 4;
constexpr double kMinAngle_deg = 1.5;
// All pairs of rays are compared; of longer tracks only every n-th view is used.
constexpr std::size_t kMaxRays = 512;

std::vector<DVec3> raysOf(const ColmapPoint& point, const ColmapModel& model) {
  std::vector<DVec3> rays;
  const std::size_t step = (point.images.size() + kMaxRays - 1) / kMaxRays;
  for (std::size_t k = 0; k < point.images.size(); k += step) {
    const DVec3 way = point.position - model.images[point.images[k]].center;
    const double length = glm::length(way);
    if (length > 0) rays.push_back(way / length);
  }
  return rays;
}

/// Whether two of the rays, taken as lines, meet at that angle or a larger one.
bool spread(const std::vector<DVec3>& rays, double leastSine) {
  for (std::size_t a = 0; a < rays.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (glm::length(glm::cross(rays[a], rays[b])) >= leastSine) return true;
  return false;
}

}  // namespace

Reliability reliabilityOf(const ColmapPoint& point, const ColmapModel& model) {
  static const double leastSine = std::sin(kMinAngle_deg * std::numbers::pi / 180);
  if (point.images.empty()) return Reliability::reliable;
  if (point.images.size() < kMinViews) return Reliability::fewViews;
  if (point.error > kMaxError_px) return Reliability::largeError;
  return spread(raysOf(point, model), leastSine) ? Reliability::reliable : Reliability::smallAngle;
}

bool ReliabilityCounts::add(Reliability reliability) {
  ++counts_[static_cast<std::size_t>(reliability)];
  return reliability == Reliability::reliable;
}

std::uint64_t ReliabilityCounts::all() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

std::string ReliabilityCounts::sentence() const {
  std::vector<std::string> why;
  const auto add = [&](Reliability reliability, const std::string& what) {
    if (of(reliability) > 0) why.push_back(fmt::format("{} {}", of(reliability), what));
  };
  add(Reliability::smallAngle, fmt::format("with rays that meet at less than {} degrees", kMinAngle_deg));
  add(Reliability::largeError, fmt::format("with errors of more than {} pixels", kMaxError_px));
  add(Reliability::fewViews, fmt::format("that fewer than {} images saw", kMinViews));
  return fmt::format("{} of {} points, which are unreliable: {}", leftOut(), all(), fmt::join(why, ", "));
}

}  // namespace palpate
