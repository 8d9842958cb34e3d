#include "engine/motion/icp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_trigonometric.hpp>
#include <numeric>

namespace palpate {

namespace {

constexpr std::size_t kN = NormalEquations::kUnknowns;
using Row = NormalEquations::Row;
using Matrix = std::array<Row, kN>;

// Rotates axes p and q so that the entry between them becomes 0.
void rotate(Matrix& a, Matrix& columns, std::size_t p, std::size_t q) {
  if (a[p][q] == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::hypot(theta, 1.0));
  const double c = 1 / std::hypot(t, 1.0);
  const double s = t * c;
  for (std::size_t k = 0; k < kN; ++k) {
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq;
    a[k][q] = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < kN; ++k) {
    const double pk = a[p][k], qk = a[q][k];
    a[p][k] = c * pk - s * qk;
    a[q][k] = s * pk + c * qk;
    const double vp = columns[p][k], vq = columns[q][k];
    columns[p][k] = c * vp - s * vq;
    columns[q][k] = s * vp + c * vq;
  }
  a[p][q] = a[q][p] = 0;
}

// Below this mean square of the normals' components a direction is undetermined, even without noise.
constexpr double kMinShare = 2e-3;
// Safety factor on the mean contribution of noise.
constexpr double kFeignedMargin = 1.5;
constexpr double kSmallStep_m = 1e-5;
constexpr double kDegrees = 180 / 3.14159265358979323846;

// State of a pose search.
class PoseSearch {
 public:
  PoseSearch(const FrameImages& images, const CameraPose& expected) : expected_(expected), pose_(expected) {
    findMiddle(images);
  }

  IcpQuery query(const IcpOptions::Level& level) const {
    return {.level = level, .pose = pose_, .pivot = pose_.toWorld(middle_), .scale = spread_m_};
  }

  // One step in the directions whose eigenvalues exceed `least`; returns its length. Later steps may determine the
  // other directions.
  double step(const NormalEquations& equations, double least) {
    const NormalEquations::Row x = solve(equations, least);
    const DVec3 turn = DVec3(x[0], x[1], x[2]) / spread_m_, shift(x[3], x[4], x[5]);
    const double angle = glm::length(turn);
    if (angle > 0) {
      const DVec3 pivot = pose_.toWorld(middle_);
      const DQuat rotation = glm::angleAxis(angle, turn / angle);
      pose_.turn = glm::normalize(rotation * pose_.turn);
      pose_.centre = pivot + rotation * (pose_.centre - pivot);
    }
    pose_.centre += shift;
    return glm::length(shift) + angle * spread_m_;
  }

  void compare(IcpResult& result) const {
    result.pose = pose_;
    result.step_m = glm::distance(pose_.centre, expected_.centre);
    const DQuat between = glm::conjugate(expected_.turn) * pose_.turn;
    const double sine = glm::length(DVec3(between.x, between.y, between.z));
    result.turn_deg = 2 * std::atan2(sine, std::abs(between.w)) * kDegrees;
  }

 private:
  // Mean and standard deviation of a sample of the seen positions.
  void findMiddle(const FrameImages& images) {
    constexpr std::uint32_t kStride = 4;
    DVec3 sum(0);
    double squares = 0, count = 0;
    for (std::uint32_t y = 0; y < images.camera.height; y += kStride) {
      for (std::uint32_t x = 0; x < images.camera.width; x += kStride) {
        const auto depth = static_cast<double>(images.depths[std::size_t{y} * images.camera.width + x]);
        if (depth <= 0) continue;
        const DVec3 place = images.camera.placeAt(x, y, depth);
        sum += place;
        squares += glm::dot(place, place);
        count += 1;
      }
    }
    if (count == 0) return;
    middle_ = sum / count;
    spread_m_ = std::sqrt(std::max(squares / count - glm::dot(middle_, middle_), 1e-12));
  }

  CameraPose expected_, pose_;
  DVec3 middle_{0, 0, 1};  // in the camera's coordinates
  double spread_m_ = 1;
};

bool hasTooFew(const IcpSums& sums, const IcpOptions& options, IcpResult& result) {
  result.matched = sums.seen ? static_cast<double>(sums.pairs) / static_cast<double>(sums.seen) : 0;
  return sums.pairs < 6 * NormalEquations::kUnknowns || result.matched < options.fewestMatched;
}

// Smallest eigenvalue at which a direction counts as determined.
double judge(const IcpSums& sums, IcpResult& result) {
  const double weights = sums.equations.weights;
  result.weakest = eigenSymmetric(sums.equations.matrix).values[0] / weights;
  result.feigned = sums.feigned / weights;
  return (kMinShare + kFeignedMargin * result.feigned) * weights;
}

}  // namespace

void NormalEquations::add(const Row& row, double residual, double weight) {
  for (std::size_t i = 0; i < kN; ++i) {
    for (std::size_t j = 0; j < kN; ++j) matrix[i][j] += weight * row[i] * row[j];
    side[i] += weight * row[i] * residual;
  }
  weights += weight;
  squares += weight * residual * residual;
}

NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  for (std::size_t i = 0; i < kN; ++i) {
    for (std::size_t j = 0; j < kN; ++j) matrix[i][j] += other.matrix[i][j];
    side[i] += other.side[i];
  }
  weights += other.weights;
  squares += other.squares;
  return *this;
}

Eigen6 eigenSymmetric(Matrix a) {
  Matrix columns{};
  double trace = 0;
  for (std::size_t k = 0; k < kN; ++k) {
    columns[k][k] = 1;
    trace += std::fabs(a[k][k]);
  }
  constexpr int kMaxSweeps = 32;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double offDiagonal = 0;
    for (std::size_t p = 0; p < kN; ++p)
      for (std::size_t q = p + 1; q < kN; ++q) offDiagonal += std::fabs(a[p][q]);
    if (!(offDiagonal > 1e-18 * trace)) break;
    for (std::size_t p = 0; p < kN; ++p)
      for (std::size_t q = p + 1; q < kN; ++q) rotate(a, columns, p, q);
  }
  std::array<std::size_t, kN> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return a[k][k]; });
  Eigen6 eigen;
  for (std::size_t k = 0; k < kN; ++k) {
    eigen.values[k] = a[order[k]][order[k]];
    eigen.vectors[k] = columns[order[k]];
  }
  return eigen;
}

Row solve(const NormalEquations& equations, double least) {
  const Eigen6 eigen = eigenSymmetric(equations.matrix);
  Row x{};
  for (std::size_t k = 0; k < kN; ++k) {
    if (!(eigen.values[k] > least)) continue;
    const Row& v = eigen.vectors[k];
    const double along = std::inner_product(v.begin(), v.end(), equations.side.begin(), 0.0);
    for (std::size_t i = 0; i < kN; ++i) x[i] -= along / eigen.values[k] * v[i];
  }
  return x;
}

IcpSums& IcpSums::operator+=(const IcpSums& other) {
  equations += other.equations;
  seen += other.seen;
  pairs += other.pairs;
  feigned += other.feigned;
  return *this;
}

std::string IcpResult::why() const {
  switch (state) {
    case IcpState::found:
      return "its pose was found";
    case IcpState::tooFewMatches:
      return fmt::format("only {:.0f} % of its surface is in the map", 100 * matched);
    case IcpState::degenerate:
      return fmt::format(
          "its surface does not determine the pose (a plane, or too even): the least certain direction has a "
          "share of {:.4f}, and noise alone {:.4f}",
          weakest, feigned);
    case IcpState::tooFar:
      return fmt::format("its surface is off the map by {:.1f} times the noise of depth", residual);
    case IcpState::jumped:
      return fmt::format("the camera would have jumped by {:.3f} m and {:.1f} degrees", step_m, turn_deg);
  }
  return {};
}

IcpResult searchPose(const FrameImages& images, const CameraPose& expected, const IcpOptions& options,
                     const SumPairs& sumPairs) {
  PoseSearch search(images, expected);
  IcpResult result;
  for (const IcpOptions::Level& level : options.levels) {
    for (int iteration = 0; iteration < level.iterations; ++iteration) {
      const IcpSums sums = sumPairs(search.query(level));
      if (hasTooFew(sums, options, result)) return result;
      if (search.step(sums.equations, judge(sums, result)) < kSmallStep_m) break;
    }
  }
  const IcpSums sums = sumPairs(search.query(options.levels.back()));
  if (hasTooFew(sums, options, result)) return result;
  const double least = judge(sums, result);
  result.residual = std::sqrt(sums.equations.squares / static_cast<double>(sums.pairs));
  search.compare(result);
  result.state = IcpState::found;
  if (!(result.weakest * sums.equations.weights > least)) result.state = IcpState::degenerate;
  if (result.step_m > options.longestStep_m || result.turn_deg > options.largestTurn_deg)
    result.state = IcpState::jumped;
  if (result.residual > options.largestResidual) result.state = IcpState::tooFar;
  return result;
}

}  // namespace palpate
