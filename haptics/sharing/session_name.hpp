// The name of a session, unique on its network.
#pragma once

#include <string>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate::sharing {

class SessionName {
 public:
  /// `log` may be null; the arguments must outlive this.
  SessionName(dds_entity_t participant, const Topics& topics, std::string name, Log* log);
  /// Listens for a second. Throws NetworkError if another program serves a session of that name.
  void requireFree(const StopSign& stop);
  /// Publishes the notice, which has the name in it, until this is destroyed.
  void announce(const Notice& notice);
  /// Checks from time to time for a session of the same name that began in the same second, so that neither had heard
  /// the other. Both compare the times of their announcements, by whatever clocks: the later one, or at equal times the
  /// one with the greater id, throws NetworkError. A session that is ten seconds old never ends for another one; it
  /// logs the conflict.
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
