// Who else takes part in a session, as scripts read it.
#pragma once

#include <span>

#include "apps/cli/json.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

Json toJson(std::span<const SeenHand> hands);
Json toJson(std::span<const SeenCamera> cameras);

}  // namespace palpate
