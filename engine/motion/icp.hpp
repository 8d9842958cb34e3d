#pragma once

#include <array>
#include <string>

#include "engine/motion/map_view.hpp"

namespace palpate {

/// How a pose is looked for. Distances in metres.
struct IcpOptions {
  struct Level {
    std::uint32_t stride;  ///< every so many pixels, along rows and columns
    double gate_m;         ///< pairs are no farther apart
    int iterations;        ///< at most
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

/// The pose from which the frame's surfaces lie on the map, looked for about `expected`. Computes in double precision,
/// with sums in the order of the rows: the same for any number of threads.
IcpResult findPose(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected, const IcpOptions& options = {});

}  // namespace palpate
