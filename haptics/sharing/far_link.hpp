// The points around the hands of a session that another program serves.
#pragma once

#include <memory>

#include "engine/core/log.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/served_file.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate {

class JoinedSession;

struct FarParts {
  std::shared_ptr<const JoinedSession> session;
  sharing::SessionNotice notice;
  FarFacts facts;
  Log* log = nullptr;  ///< logs silence and its end; must outlive the cloud
};
std::unique_ptr<BrickCloud> openFarCloud(const FarParts& parts);

/// Of all points, and of their file.
struct HeardFacts : FarFacts {
  sharing::ServedFile file;
};
/// Facts that the session's server announces; nothing if they are not received within `timeout_s`. Throws NetworkError
/// if they describe no valid cloud.
std::optional<HeardFacts> hearFacts(const JoinedSession& session, double timeout_s, const StopSign& stop);

}  // namespace palpate
