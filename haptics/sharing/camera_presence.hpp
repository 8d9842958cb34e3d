// From where the others look at a session's cloud, and from where this program does.
#pragma once

#include <memory>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/shared_cameras.hpp"

namespace palpate {

class JoinedSession;

/// Of whoever has joined a session, whether he has all of its points or those around his hands, and whether or not he
/// sculpts. On a thread of its own. `name`: of this hand, where the others see it; empty: as the machine. `cloud`:
/// about which the others are.
std::shared_ptr<SharedCameras> shareCameras(std::shared_ptr<const JoinedSession> session, const std::string& name,
                                            const PointCloud& cloud);

}  // namespace palpate
