#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/version_watch.hpp"

namespace palpate {

/// Where a cloud came from, and as whom.
class JoinedSession {
 public:
  JoinedSession(const NetworkConfig& given, sharing::Id joined, sharing::Id own)
      : network(given),
        participant(given, sharing::versionQos(sharing::kVersion)),
        topics(participant),
        session(joined),
        client(own) {}

  NetworkConfig network;
  sharing::Participant participant;
  sharing::Topics topics;
  sharing::Id session, client;
  std::string name, host;
  bool sculptable = false;
};

/// What is asked of its server.
sharing::ResumeRequest requestOf(const JoinedSession& session, const sharing::Resume& asked);
/// What its server has said, of a cloud of so many points; the states stand in `states`. Nothing where it is another
/// session's, or one of them is none: no server of ours says that, and whoever else does is not heard.
std::optional<sharing::Results> resultsOf(const JoinedSession& session, const sharing::Result& said, std::size_t points,
                                          std::vector<PointState>& states);

}  // namespace palpate
