// Which network a session is shared on, and which sessions are on it. Independent of DDS.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

/// Failure of the other side or of the network: exit code 1.
class NetworkError : public Error {
 public:
  using Error::Error;
};

/// Called each twentieth of a second by functions that wait for others, on the waiting thread: true ends the wait with
/// a NetworkError. Empty: waits until its timeout.
using StopSign = std::function<bool()>;
/// Throws NetworkError if the wait is to end.
inline void throwIfStopped(const StopSign& stop) {
  if (stop && stop()) throw NetworkError("interrupted");
}

struct NetworkConfig {
  /// Interface of this machine, as `ip link` names it, or its address; empty: this machine only.
  std::string interface;
  /// Addresses of machines to contact directly, for networks without multicast.
  std::vector<std::string> peers;
  std::uint32_t domain = 0;  ///< of DDS; the same as ROS's
  /// Folder of keys (security.hpp): everything is encrypted, and programs without keys of the same authority cannot
  /// find, join or hear a session. Empty: nothing is encrypted.
  std::string security;

  bool operator==(const NetworkConfig&) const = default;
};

/// False if palpate was built without PALPATE_NETWORK: everything here then throws NetworkError.
bool canShare();

/// Who can access what on such a network, as a sentence. Throws FileError for faulty keys.
std::string opennessOf(const NetworkConfig& network);

/// A session that a program serves.
struct ServedSession {
  std::string name, host, model;
  std::uint64_t points = 0;
  std::uint32_t version = 0;  ///< of the network protocol
  bool compatible = true;     ///< equal to this program's version
  std::uint32_t pings = 0, answered = 0;
  std::optional<double> roundTrip_ms;  ///< median, if any was answered
};

struct NetworkSurvey {
  std::vector<ServedSession> sessions;
  bool keyHolders = false;  ///< there are other programs with keys, whether or not they can be heard here
};

/// Listens for `seconds`, then pings the sessions found, which takes half a second, and up to two more if pings are
/// lost. Throws NetworkError, UsageError.
NetworkSurvey discoverSessions(const NetworkConfig& network, double seconds, const StopSign& stop = {});

}  // namespace palpate
