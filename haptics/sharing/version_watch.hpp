// Who is on the network with another version of palpate, and cannot join what is served here.
#pragma once

#include <set>

#include "haptics/sharing/dds.hpp"

namespace palpate::sharing {

/// What the participant of who joins says of itself, so that servers of other versions know who it was.
Qos versionQos(std::uint32_t version);

/// One thread uses it at a time.
class VersionWatch {
 public:
  explicit VersionWatch(const Participant& participant);
  /// The versions, other than this one's, of those that have come since the last call; each once.
  std::set<std::uint32_t> fresh();

 private:
  Entity reader_;
  std::set<std::uint32_t> known_;
};

}  // namespace palpate::sharing
