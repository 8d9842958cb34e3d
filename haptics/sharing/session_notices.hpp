// Finds the sessions served on a network.
#pragma once

#include <string>
#include <vector>

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

}  // namespace palpate::sharing
