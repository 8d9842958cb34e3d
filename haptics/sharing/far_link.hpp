// The points around the hands of a session that somebody else serves.
#pragma once

#include <memory>

#include "engine/core/log.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate {

class JoinedSession;

struct FarParts {
  std::shared_ptr<const JoinedSession> session;
  sharing::SessionNotice notice;
  FarFacts facts;
  Log* log = nullptr;  ///< hears of silence and of its end; outlives it
};
std::unique_ptr<FarCloud> openFarCloud(const FarParts& parts);

/// What a session's server says of it; nothing where it has not come within `patience_s`. Throws NetworkError for what
/// is of no cloud.
std::optional<FarFacts> hearFacts(const JoinedSession& session, double patience_s, const StopSign& stop);

}  // namespace palpate
