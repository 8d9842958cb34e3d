// Results of `bench coexist`: touch beside pictures that are drawn as fast as possible.
#pragma once

#include "apps/cli/context.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

/// The pictures drawn during the stroke.
struct SightPace {
  std::string gpu;
  std::uint64_t pictures = 0;
  double perSecond = 0;
  Summary picture_ms;               ///< from reading the edits until the picture is complete
  Summary follow_ms;                ///< the part of picture_ms spent on the edits: points and discs
  std::uint64_t statesSeen = 0;     ///< states of edited points, as the pictures received them
  std::uint64_t changedPixels = 0;  ///< pixels that differ between the first picture and the last
};

/// A stroke in real time on one model, by one arrangement of queues.
struct Coexistence {
  std::string subject, backend, queues, situation;
  std::size_t points = 0;
  double rate_Hz = 0, duration_s = 0;
  std::uint64_t ticks = 0, contactTicks = 0;
  std::uint64_t missedTicks = 0;            ///< dropped because their time had passed
  double freshShare = 0;                    ///< fraction of the ticks that were answered in time
  Summary step_us;                          ///< from pose to force
  double lateP999_us = 0, lateMost_us = 0;  ///< from the time a tick was due to its start
  bool realtimePriority = false;            ///< granted to the servo thread
  std::uint64_t edits = 0, leftOut = 0;
  std::uint64_t statesMade = 0;  ///< states of points that the edits produced
  double brushRadius_mm = 0;     ///< 0 without edits
  std::optional<SightPace> sight;
};

struct CoexistenceResults {
  std::uint32_t width = 0, height = 0, samples = 1;  ///< of the pictures; samples of a pixel
  std::vector<Coexistence> rows;
};
Json toJson(const CoexistenceResults& results);

}  // namespace palpate
