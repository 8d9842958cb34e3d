#pragma once

#include <array>
#include <functional>
#include <string>

#include "engine/motion/fusion.hpp"
#include "engine/motion/normal_equations.hpp"

namespace palpate {

/// How a pose is looked for. Distances in metres.
struct IcpOptions {
  struct Level {
    std::uint32_t stride = 1;  ///< every so many pixels, along rows and columns
    double gate_m = 0;         ///< pairs are no farther apart
    int iterations = 1;        ///< at most
  };
  std::array<Level, 3> levels{{{4, 0.2, 10}, {2, 0.1, 8}, {1, 0.05, 6}}};  ///< from coarse to fine
  double fewestMatched = 0.3;    ///< share of the pixels with a surface that must find a point of the map
  double largestResidual = 2.5;  ///< in deviations of the noise, root mean square
  double longestStep_m = 0.3;    ///< from the pose that was expected
  double largestTurn_deg = 20;   ///< likewise
};

enum class IcpState {
  found,
  tooFewMatches,  ///< what is seen is not in the map, or stands elsewhere
  degenerate,     ///< what is seen does not say where the camera is, as a plane along which it may have slid
  tooFar,         ///< what is seen does not lie on the map
  jumped          ///< it would have moved farther than it may
};

struct IcpResult {
  IcpState state = IcpState::tooFewMatches;
  CameraPose pose;      ///< in the world; to be believed in state `found` alone
  double matched = 0;   ///< share of the pixels with a surface
  double residual = 0;  ///< root mean square, in deviations of the noise
  /// The least certain direction of motion: the mean square of the normals' share in it, and how much of that noise in
  /// the normals alone may feign. Rotations count by what they move at the deviation of the places that are seen.
  double weakest = 0, feigned = 0;
  double step_m = 0, turn_deg = 0;  ///< from the pose that was expected

  /// In words, for who reads why a frame was left out.
  std::string why() const;
};

/// Which pairs of pixels and points of the map are asked for. In the world.
struct IcpQuery {
  IcpOptions::Level level;
  CameraPose pose;   ///< from which the frame is taken to be seen
  DVec3 pivot{0};    ///< that rotations are about
  double scale = 1;  ///< m; an angle times this is the unknown
};

/// What the pairs say, all together: unknowns are a rotation (times the scale), then a translation.
struct IcpSums {
  NormalEquations equations;
  std::uint64_t seen = 0;   ///< pixels with a surface
  std::uint64_t pairs = 0;  ///< that have found a point
  double feigned = 0;       ///< sum of w times the variance of the points' normals

  IcpSums& operator+=(const IcpSums& other);
};
using SumPairs = std::function<IcpSums(const IcpQuery&)>;

/// The pose from which a frame lies on the map whose pairs `sumPairs` sums up, looked for about `expected`, by
/// point-to-plane ICP (Chen and Medioni 1992; Low 2004) from coarse to fine. In directions that the pairs tell nothing
/// of it does not move.
IcpResult searchPose(const FrameImages& images, const CameraPose& expected, const IcpOptions& options,
                     const SumPairs& sumPairs);

}  // namespace palpate
