#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/version_watch.hpp"

namespace palpate {

/// Where a cloud was joined, and as which client.
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
  std::uint64_t checksum = 0;  ///< of the served points
};

/// Edits of others in a sample of its server, of a cloud of that many points; the result refers to `states`. Nothing if
/// it contains an invalid state: no palpate server sends that, so it is ignored.
std::optional<sharing::Results> resultsOf(const sharing::Points& sample, std::size_t points,
                                          std::vector<PointState>& states);

}  // namespace palpate
