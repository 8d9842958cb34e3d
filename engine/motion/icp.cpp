#include "engine/motion/icp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_trigonometric.hpp>

#include "engine/core/parallel.hpp"
#include "engine/motion/normal_equations.hpp"
#include "shaders/shared/icp.h"

namespace palpate {

namespace {

// Below this mean square of the normals' share a direction of motion is not known, even without noise.
constexpr double kLeastShare = 2e-3;
// Times what noise feigns on average, for chance.
constexpr double kFeignedMargin = 1.5;
constexpr double kSmallStep_m = 1e-5;

// Sums over the pairs of some rows of pixels.
struct PairSums {
  NormalEquations equations;
  std::uint64_t seen = 0, pairs = 0;
  double feigned = 0;     // sum of w times the variance of the normals
  double deviations = 0;  // sum of squared residuals, in deviations, each as far as it pulls

  PairSums& operator+=(const PairSums& other) {
    equations += other.equations;
    seen += other.seen;
    pairs += other.pairs;
    feigned += other.feigned;
    deviations += other.deviations;
    return *this;
  }
};

class PoseSearch {
 public:
  PoseSearch(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
             const CameraPose& expected)
      : map_(map),
        images_(images),
        surfaces_(surfaces),
        expected_(expected),
        pose_(expected),
        view_(fusionView(images, expected, map.origin(), map.options())) {
    viewMap(map, view_, mapView_);
    findMiddle();
  }

  PairSums sumPairs(const IcpOptions::Level& level) const {
    const std::size_t rows = (view_.height + level.stride - 1) / level.stride;
    std::vector<PairSums> sums(rows);
    // Counted in pixels, and each row taken by whoever has its first one.
    parallelFor(rows * view_.width, map_.options().threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = (begin + view_.width - 1) / view_.width; row * view_.width < end; ++row)
        sums[row] = sumRow(static_cast<std::uint32_t>(row) * level.stride, level);
    });
    PairSums all;
    for (const PairSums& row : sums) all += row;
    return all;
  }

  // Says what the pairs tell of the pose; the least eigenvalue, per weight, of a direction that they do.
  double judge(const PairSums& sums, IcpResult& result) const {
    result.weakest = eigenSymmetric(sums.equations.matrix).values[0] / sums.equations.weights;
    result.feigned = sums.feigned / sums.equations.weights;
    return kLeastShare + kFeignedMargin * result.feigned;
  }

  // One step, in the directions that the pairs tell of; how far it went. Others may be known once more has come
  // together.
  double step(const PairSums& sums, double leastShare) {
    const NormalEquations::Row x = solve(sums.equations, leastShare * sums.equations.weights);
    const DVec3 turn = DVec3(x[0], x[1], x[2]) / spread_m_, shift(x[3], x[4], x[5]);
    const double angle = glm::length(turn);
    const DVec3 q = pivot();
    if (angle > 0) {
      const DQuat rotation = glm::angleAxis(angle, turn / angle);
      pose_.turn = glm::normalize(rotation * pose_.turn);
      pose_.centre = q + rotation * (pose_.centre - q);
    }
    pose_.centre += shift;
    return glm::length(shift) + angle * spread_m_;
  }

  void compare(IcpResult& result) const {
    result.pose = pose_;
    result.step_m = glm::distance(pose_.centre, expected_.centre);
    const DQuat between = glm::conjugate(expected_.turn) * pose_.turn;
    result.turn_deg = 2 * std::atan2(glm::length(DVec3(between.x, between.y, between.z)), std::abs(between.w)) *
                      (180 / 3.14159265358979323846);
  }

 private:
  DVec3 pivot() const { return pose_.toWorld(middle_); }

  // Mean and deviation of what the pixels see.
  void findMiddle() {
    DVec3 sum(0);
    double squares = 0, count = 0;
    for (std::uint32_t y = 0; y < view_.height; ++y) {
      for (std::uint32_t x = 0; x < view_.width; ++x) {
        const shared::PixelSurface& surface = surfaces_[std::size_t{y} * view_.width + x];
        if (!(surface.depth > 0)) continue;
        const DVec3 place(shared::placeOfPixel(view_, {x, y}, surface.depth));
        sum += place;
        squares += glm::dot(place, place);
        count += 1;
      }
    }
    if (count == 0) return;
    middle_ = sum / count;
    spread_m_ = std::sqrt(std::max(squares / count - glm::dot(middle_, middle_), 1e-12));
  }

  PairSums sumRow(std::uint32_t row, const IcpOptions::Level& level) const {
    PairSums sums;
    for (std::uint32_t column = 0; column < view_.width; column += level.stride) addPixel({column, row}, level, sums);
    return sums;
  }

  void addPixel(UVec2 pixel, const IcpOptions::Level& level, PairSums& sums) const {
    const std::size_t index = std::size_t{pixel.y} * view_.width + pixel.x;
    const shared::PixelSurface& surface = surfaces_[index];
    if (!(surface.depth > 0)) return;
    ++sums.seen;
    const DVec3 inMap = pose_.toWorld(DVec3(shared::placeOfPixel(view_, pixel, images_.depths[index]))) - map_.origin();
    const shared::Projection projection = shared::projectionOf(view_, Vec3(inMap));
    if (!projection.inView) return;
    const std::uint32_t id = mapView_.ids[std::size_t{projection.pixel.y} * view_.width + projection.pixel.x];
    if (id == MapView::kNoPoint) return;
    const shared::Surfel& surfel = map_.surfel(id);
    const double deviation = static_cast<double>(shared::depthDeviation(view_.noise, surface.depth));
    const auto pair =
        shared::icpPair(inMap, pose_.turn * DVec3(surface.normal), DVec3(surfel.place), DVec3(surfel.normal),
                        pivot() - map_.origin(), spread_m_, level.gate_m, deviation);
    if (!pair.isPair) return;
    ++sums.pairs;
    sums.equations.add({pair.turn.x, pair.turn.y, pair.turn.z, pair.shift.x, pair.shift.y, pair.shift.z}, pair.residual,
                       pair.weight);
    sums.deviations += pair.weight * pair.residual * pair.residual;
    sums.feigned += pair.weight * normalVariance(surface.depth, deviation, surfel.record);
  }

  // Of a point's normal in one direction: of a slope over 7 x 7 pixels, less by how often it was measured.
  double normalVariance(float depth, double deviation, const shared::SurfelRecord& record) const {
    const double footprint = static_cast<double>(depth / std::min(view_.camera.fx, view_.camera.fy));
    constexpr double kSquares = 196;  // sum of x^2 over the square
    const double once = deviation * deviation / (kSquares * footprint * footprint);
    const double measurement = static_cast<double>(shared::measurementWeight(view_, depth));
    return once * std::min(1.0, measurement / static_cast<double>(record.weight));
  }

  const SurfelMap& map_;
  const FrameImages& images_;
  const std::vector<shared::PixelSurface>& surfaces_;
  CameraPose expected_, pose_;
  shared::FusionView view_;  // from the expected pose
  MapView mapView_;
  DVec3 middle_{0, 0, 1};  // of the places that the pixels see, in the camera's coordinates
  double spread_m_ = 1;
};

bool hasTooFew(const PairSums& sums, const IcpOptions& options, IcpResult& result) {
  result.matched = sums.seen ? static_cast<double>(sums.pairs) / static_cast<double>(sums.seen) : 0;
  return sums.pairs < 6 * NormalEquations::kUnknowns || result.matched < options.fewestMatched;
}

}  // namespace

std::string IcpResult::why() const {
  switch (state) {
    case IcpState::found:
      return "its pose was found";
    case IcpState::tooFewMatches:
      return fmt::format("only {:.0f} % of what it sees is in the map", 100 * matched);
    case IcpState::degenerate:
      return fmt::format(
          "what it sees does not say where the camera is (a plane, or too even): the least certain "
          "direction has a share of {:.4f}, and noise alone {:.4f}",
          weakest, feigned);
    case IcpState::tooFar:
      return fmt::format("what it sees lies {:.1f} times the noise of its depth off the map", residual);
    case IcpState::jumped:
      return fmt::format("the camera would have jumped by {:.3f} m and {:.1f} degrees", step_m, turn_deg);
  }
  return {};
}

IcpResult findPose(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected, const IcpOptions& options) {
  PoseSearch search(map, images, surfaces, expected);
  IcpResult result;
  for (const IcpOptions::Level& level : options.levels) {
    for (int iteration = 0; iteration < level.iterations; ++iteration) {
      const PairSums sums = search.sumPairs(level);
      if (hasTooFew(sums, options, result)) return result;
      if (search.step(sums, search.judge(sums, result)) < kSmallStep_m) break;
    }
  }
  const PairSums sums = search.sumPairs(options.levels.back());
  if (hasTooFew(sums, options, result)) return result;
  const double leastShare = search.judge(sums, result);
  result.residual = std::sqrt(sums.deviations / static_cast<double>(sums.pairs));
  search.compare(result);
  result.state = IcpState::found;
  if (!(result.weakest > leastShare)) result.state = IcpState::degenerate;
  if (result.step_m > options.longestStep_m || result.turn_deg > options.largestTurn_deg)
    result.state = IcpState::jumped;
  if (result.residual > options.largestResidual) result.state = IcpState::tooFar;
  return result;
}

}  // namespace palpate
