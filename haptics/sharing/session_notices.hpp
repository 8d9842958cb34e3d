// Which sessions are served on a network.
#pragma once

#include <string>
#include <vector>

#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// A Notice whose words and numbers have been looked at.
struct SessionNotice {
  Id session{};
  std::uint32_t version = 0;
  std::string name, host, model;
  std::uint64_t points = 0;
  DVec3 origin{0};
  double mm_per_unit = 0;
  bool colored = false, sculptable = false;
  std::uint64_t checksum = 0;
  dds_time_t moment_ns = 0;  ///< at which it was announced, by its own clock
};

class SessionNotices {
 public:
  SessionNotices(dds_entity_t participant, const Topics& topics);
  /// All that are known now, and have not ended.
  const std::vector<SessionNotice>& known();
  /// All that are known once `seconds` have passed. Throws NetworkError where it is to end before.
  std::vector<SessionNotice> listen(double seconds, const StopSign& stop = {});
  /// The same, or sooner: once one of that name is there.
  std::vector<SessionNotice> listenFor(const std::string& name, double seconds);

 private:
  void take();

  Reader<Notice> reader_;
  ReaderWait wait_;
  std::vector<SessionNotice> known_;
};

}  // namespace palpate::sharing
