// Finds the sessions served on a network.
#pragma once

#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// A Notice whose texts and numbers are validated.
struct SessionNotice {
  Id session{};
  std::uint32_t version = 0;
  std::string name, host, model;
  std::uint64_t points = 0;
  DVec3 origin{0};
  double mm_per_unit = 0;
  bool colored = false, sculptable = false;
  std::uint64_t checksum = 0;
  dds_time_t moment_ns = 0;  ///< time of its announcement, by its server's clock
};

class SessionNotices {
 public:
  SessionNotices(dds_entity_t participant, const Topics& topics);
  /// All known sessions that have not ended.
  const std::vector<SessionNotice>& known();
  /// All sessions known after `seconds`. Throws NetworkError if it is stopped before.
  std::vector<SessionNotice> listen(double seconds, const StopSign& stop = {});
  /// The same, or sooner: once a session of that name is found.
  std::vector<SessionNotice> listenFor(const std::string& name, double seconds);

 private:
  void take();

  Reader<Notice> reader_;
  ReaderWait wait_;
  std::vector<SessionNotice> known_;
};

/// The name of a session, unique on its network.
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
