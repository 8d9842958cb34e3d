// Detects programs of other palpate versions on the network, which cannot join sessions served here.
#pragma once

#include <set>

#include "haptics/sharing/dds.hpp"

namespace palpate::sharing {

/// User data with the version of a joining participant, so that servers of other versions can report it.
Qos versionQos(std::uint32_t version);

/// Not thread-safe.
class VersionWatch {
 public:
  explicit VersionWatch(const Participant& participant);
  /// Versions other than this one that have appeared since the last call; each once.
  std::set<std::uint32_t> fresh();

 private:
  Entity reader_;
  std::set<std::uint32_t> known_;
};

}  // namespace palpate::sharing
