// How long a back end takes for a tick, measured without a device.
#pragma once

#include <span>

#include "engine/core/statistics.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/sculpting_hand.hpp"

namespace palpate {

struct TickTimeRequest {
  const BackendKind& kind;
  const SessionConfig& config;  ///< without a brush the surface is only felt
  const Model& model;           ///< a cloud at rest
  std::span<const SurfaceSpot> places;
  std::span<const Stroke> strokes;  ///< one after another on the same points; their brushes replace the configured one
  unsigned threads = 0;             ///< on the CPU; 0: one per core
  /// Duration of each stroke, without making the back end; longer on a machine too slow for ten ticks.
  double duration_s = 0.3;
  std::size_t ticks = 1000;  ///< maximum number of each stroke
};

/// Times of the ticks of each stroke, us, on a back end made for this: query, edit and index, one tick after another
/// without a pause, all of them at full depth, once the machine has reached its usual clock. No device takes part, so
/// that there is no force. Throws Error if the back end cannot be made or gives no valid answer, and if no tick of a
/// stroke has reached the surface.
std::vector<Summary> tickTimes(const TickTimeRequest& request);

}  // namespace palpate
