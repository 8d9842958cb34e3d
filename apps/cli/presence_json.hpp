// The other participants of a session as JSON, for scripts.
#pragma once

#include <span>

#include "apps/cli/json.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

Json toJson(std::span<const SeenHand> hands);
Json toJson(std::span<const SeenCamera> cameras);

}  // namespace palpate
