// A joined cloud that is sculpted: what this hand does goes to the server, and what the others do comes here.
#pragma once

#include <memory>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/core/touch_backend.hpp"
#include "haptics/shared_follower.hpp"

namespace palpate {

/// The session that a cloud was joined from (joinCloud()).
class JoinedSession;

struct SharedParts {
  std::shared_ptr<const JoinedSession> session;
  const PointCloud& cloud;  ///< as it was joined
  TouchBackend& backend;  ///< made of it, with a brush that keeps points, which may be taken away again; it keeps edits
  Log* log = nullptr;     ///< hears of silence and of its end
};

/// Begins to exchange strokes, on a thread of its own. What goes wrong there for good is thrown by catchUp(), as a
/// NetworkError. All that `parts` refers to outlives it.
std::unique_ptr<SharedFollower> shareEdits(const SharedParts& parts);

}  // namespace palpate
