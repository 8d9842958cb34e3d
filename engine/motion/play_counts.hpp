#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "engine/core/camera_frustum.hpp"

namespace palpate {

/// Counts of a depth camera's frames so far.
struct PlayCounts {
  std::uint64_t played = 0;   ///< newest frame at a requested time
  std::uint64_t lost = 0;     ///< could not be read
  std::uint64_t dropped = 0;  ///< not played: a later one was due or already received
  std::string lastLoss;       ///< reason of the last loss; empty: none
  /// Live cameras: session time of the last frame, if that is more than a second ago or no more frames will follow.
  std::optional<double> silentSince_s;
  double staysTrue_s = std::numeric_limits<double>::infinity();  ///< live cameras: DepthStream::staysTrue_s()
};

/// View of the frame that a depth camera plays.
struct PlayedView {
  CameraFrustum frustum;     ///< metres, in the world of the poses
  std::uint64_t number = 0;  ///< frame number (DepthFrame::number)
};

}  // namespace palpate
