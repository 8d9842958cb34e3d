#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>

#include "engine/motion/fusion.hpp"

namespace palpate {

/// Weighted least squares with six unknowns in double precision: sums over rows J with residual r, minimising |J x +
/// r|.
struct NormalEquations {
  static constexpr std::size_t kUnknowns = 6;
  using Row = std::array<double, kUnknowns>;
  std::array<Row, kUnknowns> matrix{};  ///< sum of w J J^T, both halves
  Row side{};                           ///< sum of w J r
  double weights = 0;                   ///< sum of w
  double squares = 0;                   ///< sum of w r^2

  void add(const Row& row, double residual, double weight);
  NormalEquations& operator+=(const NormalEquations& other);
};

/// Eigenvalues, ascending, and unit eigenvectors of a symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan
/// 2013, section 8.5).
struct Eigen6 {
  NormalEquations::Row values{};
  std::array<NormalEquations::Row, NormalEquations::kUnknowns> vectors{};
};
Eigen6 eigenSymmetric(std::array<NormalEquations::Row, NormalEquations::kUnknowns> matrix);

/// Least-squares x without components along eigenvectors whose eigenvalues are not above `least`.
NormalEquations::Row solve(const NormalEquations& equations, double least = 0);

/// Parameters of the pose search. Distances in metres.
struct IcpOptions {
  struct Level {
    std::uint32_t stride = 1;  ///< sampling step in pixels, along rows and columns
    double gate_m = 0;         ///< maximum distance of a pair
    int iterations = 1;        ///< maximum number
  };
  std::array<Level, 3> levels{{{4, 0.2, 10}, {2, 0.1, 8}, {1, 0.05, 6}}};  ///< from coarse to fine
  double fewestMatched = 0.3;    ///< minimum share of pixels with a surface that match a point of the map
  double largestResidual = 2.5;  ///< maximum, in deviations of the noise, root mean square
  double longestStep_m = 0.3;    ///< maximum distance from the expected pose
  double largestTurn_deg = 20;   ///< likewise, rotation
};

enum class IcpState {
  found,
  tooFewMatches,  ///< the scene is not in the map, or at another position
  degenerate,     ///< the scene does not determine the pose, such as a plane along which the camera may slide
  tooFar,         ///< the frame does not lie on the map
  jumped          ///< moved farther than allowed
};

struct IcpResult {
  IcpState state = IcpState::tooFewMatches;
  CameraPose pose;      ///< in the world; valid only in state `found`
  double matched = 0;   ///< share of pixels with a surface that match a point
  double residual = 0;  ///< root mean square, in deviations of the noise
  /// Least certain direction of motion: mean square of the normals' components along it, and the part of it that noise
  /// in the normals alone would produce. Rotations count by their displacement at the standard deviation of the seen
  /// positions.
  double weakest = 0, feigned = 0;
  double step_m = 0, turn_deg = 0;  ///< from the expected pose

  /// Description for messages about frames that were left out.
  std::string why() const;
};

/// Parameters for pairing pixels with points of the map. World coordinates.
struct IcpQuery {
  IcpOptions::Level level;
  CameraPose pose;   ///< assumed pose of the frame
  DVec3 pivot{0};    ///< centre of rotations
  double scale = 1;  ///< m; an angle times this is the unknown
};

/// Sums over all pairs: the unknowns are a rotation (times the scale), then a translation.
struct IcpSums {
  NormalEquations equations;
  std::uint64_t seen = 0;   ///< pixels with a surface
  std::uint64_t pairs = 0;  ///< pixels that match a point
  double feigned = 0;       ///< sum of w times the variance of the points' normals

  IcpSums& operator+=(const IcpSums& other);
};
using SumPairs = std::function<IcpSums(const IcpQuery&)>;

/// Pose in which a frame lies on the map, searched from `expected` by point-to-plane ICP (Chen and Medioni 1992; Low
/// 2004) from coarse to fine. `sumPairs` sums up pairs with the map. The pose does not move in directions that the
/// pairs do not determine.
IcpResult searchPose(const FrameImages& images, const CameraPose& expected, const IcpOptions& options,
                     const SumPairs& sumPairs);

}  // namespace palpate
