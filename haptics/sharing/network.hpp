// Which network a session is shared on, and what there is on it. Nothing of DDS is seen here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

/// What went wrong with those on the other side, or with the network: exit code 1.
class NetworkError : public Error {
 public:
  using Error::Error;
};

/// Asked by whatever waits for others, on the thread that waits, each twentieth of a second: true ends it with a
/// NetworkError. Empty: it waits as long as it was told.
using StopSign = std::function<bool()>;
/// Throws NetworkError where it is to end.
inline void throwIfStopped(const StopSign& stop) {
  if (stop && stop()) throw NetworkError("interrupted");
}

struct NetworkConfig {
  /// Of the machine, as `ip link` names it, or its address; empty: nobody but this machine.
  std::string interface;
  /// Addresses of machines that are asked by name, where the network carries no multicast.
  std::vector<std::string> peers;
  std::uint32_t domain = 0;  ///< of DDS; ROS has the same ones
  /// A folder of keys (security.hpp): who has none of the same authority neither finds nor joins nor hears anything,
  /// and all is encrypted. Empty: nothing is.
  std::string security;

  bool operator==(const NetworkConfig&) const = default;
};

/// False where palpate was built without DDS: everything here throws NetworkError then.
bool canShare();

/// What is open to whom on such a network, in a sentence. Throws FileError of its keys.
std::string opennessOf(const NetworkConfig& network);

/// A session that somebody serves.
struct SeenSession {
  std::string name, host, model;
  std::uint64_t points = 0;
  std::uint32_t version = 0;  ///< of what is said on the network
  bool fits = true;           ///< it is this palpate's version
  std::uint32_t pings = 0, answered = 0;
  std::optional<double> roundTrip_ms;  ///< the median, where any was answered
};

struct NetworkSurvey {
  std::vector<SeenSession> sessions;
  bool keyHolders = false;  ///< there are other programs with keys, be they such that they are heard here or not
};

/// Listens for `seconds`, and then pings whom it has found, which takes half a second, and up to two more where pings
/// are lost. Throws NetworkError, UsageError.
NetworkSurvey surveyNetwork(const NetworkConfig& network, double seconds, const StopSign& stop = {});

}  // namespace palpate
