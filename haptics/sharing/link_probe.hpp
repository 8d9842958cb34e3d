// Pings a session's server, and receives the echoes.
#pragma once

#include "engine/core/clock.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_statistics.hpp"
#include "haptics/sharing/write_request.hpp"

namespace palpate::sharing {

/// Not thread-safe.
class LinkProbe {
 public:
  /// The session must outlive it. The first pings follow each other sooner: until one is back the round trip is
  /// unknown.
  explicit LinkProbe(const JoinedSession& session);
  void attach(ReaderWait& wait) const { wait.attach(echoes_); }
  /// Receives echoes, and pings when due. Returns whether a new echo was received.
  bool turn();
  /// From now on pings another server of the session's name.
  void follow(const Id& server) { server_ = server; }
  /// Requests a write of the server's file, from the next ping on.
  void requestWrite() { request_.begin(sent_); }
  const std::optional<ServerSave>& answer() const { return request_.answer(); }
  LinkCounts counts() const { return statistics_.counts(since_.elapsed_s()); }

 private:
  Id server_, client_;
  Writer<Ping> pings_;
  Reader<Ping> echoes_;
  LinkStatistics statistics_;
  WriteRequest request_;
  std::uint32_t sent_ = 0;
  Stopwatch since_, lastPing_;
};

}  // namespace palpate::sharing
