// What `bench coexist` finds: how touch fares beside pictures that are drawn as fast as they go; a table of it.
#pragma once

#include "apps/cli/context.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

/// Of the pictures that were drawn meanwhile.
struct SightPace {
  std::string gpu;
  std::uint64_t pictures = 0;
  double perSecond = 0;
  Summary picture_ms;               ///< from the first look at the edits until the picture is there
  Summary follow_ms;                ///< of that, for the edits: points and discs
  std::uint64_t statesSeen = 0;     ///< of points that were edited, as the pictures took them in
  std::uint64_t changedPixels = 0;  ///< between the first picture and the last
};

/// A stroke in real time on one model, by one arrangement of queues.
struct Coexistence {
  std::string subject, backend, queues, situation;
  std::size_t points = 0;
  double rate_Hz = 0, duration_s = 0;
  std::uint64_t ticks = 0, contactTicks = 0;
  std::uint64_t missedTicks = 0;            ///< left out because their time had passed
  double freshShare = 0;                    ///< of the ticks: answered in time
  Summary step_us;                          ///< from pose to force
  double lateP999_us = 0, lateMost_us = 0;  ///< from when a tick was due to its begin
  bool realtimePriority = false;            ///< granted to the thread that ticks
  std::uint64_t edits = 0, leftOut = 0;
  std::uint64_t statesMade = 0;  ///< of points, by the edits
  double brushRadius_mm = 0;     ///< 0 where nothing is edited
  std::optional<SightPace> sight;
};

void printCoexistences(std::FILE* out, const std::vector<Coexistence>& all);
Json toJson(const Coexistence& found);

}  // namespace palpate
