// Hands and cameras of a session's other clients, and those of this program.
#pragma once

#include <memory>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class JoinedSession;

/// For each client of a session, whether it has all points or those around its hands, and whether or not it sculpts.
/// Runs on its own thread. `name`: of its hands, as others see them; empty: the machine's. `cloud`: the others are
/// around it.
std::shared_ptr<SharedPresence> sharePresence(std::shared_ptr<const JoinedSession> session, const std::string& name,
                                              const PointCloud& cloud);

}  // namespace palpate
