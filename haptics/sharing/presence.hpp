// Where the hands and the cameras of a session's others are, and those of this program.
#pragma once

#include <memory>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class JoinedSession;

/// Of whoever has joined a session, whether he has all of its points or those around his hands, and whether or not he
/// sculpts. On a thread of its own. `name`: of his hands, where the others see them; empty: as the machine. `cloud`:
/// about which the others are.
std::shared_ptr<SharedPresence> sharePresence(std::shared_ptr<const JoinedSession> session, const std::string& name,
                                              const PointCloud& cloud);

}  // namespace palpate
