// The name that a session is served by, which no other one of the network has.
#pragma once

#include <string>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate::sharing {

class SessionName {
 public:
  /// `log` may be null; what is given outlives this.
  SessionName(dds_entity_t participant, const Topics& topics, std::string name, Log* log);
  /// Listens for a second. Throws NetworkError where somebody serves a session of that name.
  void requireFree(const StopSign& stop);
  /// From now on others find it, until this ends. The notice bears the name.
  void announce(const Notice& notice);
  /// Looks from time to time for one of the same name that has begun in the same second, so that neither had heard the
  /// other. Both see when both were announced, by whatever clocks: the later one, or of the same moment the one of the
  /// greater id, gives way by a NetworkError. Who has been there for ten seconds gives way to nobody, whatever is
  /// announced, and says so.
  void watch();

 private:
  std::string name_;
  Log* log_;
  Writer<Notice> writer_;
  SessionNotices others_;
  Id session_{};
  dds_time_t announced_ns_ = 0;
  Stopwatch sinceAnnounced_, sinceLook_;
  bool isTold_ = false;
};

}  // namespace palpate::sharing
