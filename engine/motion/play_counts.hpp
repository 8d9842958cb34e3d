#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "engine/core/camera_frustum.hpp"

namespace palpate {

/// What became of the frames of a depth camera so far.
struct PlayCounts {
  std::uint64_t played = 0;   ///< were the newest one at a time that was asked for
  std::uint64_t lost = 0;     ///< could not be read
  std::uint64_t dropped = 0;  ///< were not played: a later one was due, or had come already
  std::string lastLoss;       ///< why the last one of those was lost; empty where none was
  /// Of a live camera: the session's time at which its last frame came, where that is more than a second ago, or no
  /// more will come.
  std::optional<double> silentSince_s;
  double staysTrue_s = std::numeric_limits<double>::infinity();  ///< of a live camera: DepthStream::staysTrue_s()
};

/// From where the frame that a depth camera plays was seen.
struct PlayedView {
  CameraFrustum frustum;     ///< metres, in the world of the poses
  std::uint64_t number = 0;  ///< of the frame (DepthFrame::number)
};

}  // namespace palpate
