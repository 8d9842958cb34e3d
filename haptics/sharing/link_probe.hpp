// Pings a session's server, and hears what comes back.
#pragma once

#include "engine/core/clock.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_statistics.hpp"

namespace palpate::sharing {

/// One thread uses it at a time.
class LinkProbe {
 public:
  /// The session outlives it.
  explicit LinkProbe(const JoinedSession& session);
  void attach(ReaderWait& wait) const { wait.attach(echoes_); }
  /// Hears, and pings when it is time to.
  void turn();
  LinkCounts counts() const { return statistics_.counts(since_.elapsed_s()); }

 private:
  const JoinedSession& session_;
  Writer<Ping> pings_;
  Reader<Ping> echoes_;
  LinkStatistics statistics_;
  Stopwatch since_, lastPing_;
};

}  // namespace palpate::sharing
