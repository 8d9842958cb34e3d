#pragma once

#include <string>

#include "haptics/sharing/messages.hpp"

namespace palpate {

/// Where a cloud came from, and as whom.
class JoinedSession {
 public:
  JoinedSession(const NetworkConfig& given, sharing::Id joined, sharing::Id own)
      : network(given), participant(given), topics(participant), session(joined), client(own) {}

  NetworkConfig network;
  sharing::Participant participant;
  sharing::Topics topics;
  sharing::Id session, client;
  std::string name, host;
  bool sculptable = false;
};

}  // namespace palpate
