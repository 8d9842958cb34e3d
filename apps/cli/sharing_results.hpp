// The JSON of a joined session: its exchange with the others, and their hands and cameras.
#pragma once

#include <span>

#include "apps/cli/results.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/shared_follower.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

/// Transmission of the points around the hands.
struct FarReport {
  FarCounts counts;
  UnknownTicks ticks;
};

Json toJson(const SharedCounts& counts);
Json toJson(const FarReport& report);
Json toJson(std::span<const SeenHand> hands);
Json toJson(std::span<const SeenCamera> cameras);

/// Appends the keys of "shared", "partial" and "other_hands" of a command's result.
void listSharingResults(std::vector<ResultFacts>& all, std::string_view command);
/// The same for "other_cameras".
void listCameraResults(std::vector<ResultFacts>& all, std::string_view command);

}  // namespace palpate
