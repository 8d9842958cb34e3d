// Pings a session's server, and hears what comes back.
#pragma once

#include "engine/core/clock.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_statistics.hpp"

namespace palpate::sharing {

/// One thread uses it at a time.
class LinkProbe {
 public:
  /// The session outlives it. The first pings go sooner one after another: until one is back the round trip is not
  /// known.
  explicit LinkProbe(const JoinedSession& session);
  void attach(ReaderWait& wait) const { wait.attach(echoes_); }
  /// Hears, and pings when it is time to. Whether an echo has come that had not come before.
  bool turn();
  /// From now on another server of the session's name is pinged.
  void follow(const Id& server) { server_ = server; }
  LinkCounts counts() const { return statistics_.counts(since_.elapsed_s()); }

 private:
  Id server_, client_;
  Writer<Ping> pings_;
  Reader<Ping> echoes_;
  LinkStatistics statistics_;
  std::uint32_t sent_ = 0;
  Stopwatch since_, lastPing_;
};

}  // namespace palpate::sharing
