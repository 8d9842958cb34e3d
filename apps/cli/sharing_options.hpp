// Options of what goes over a network: on which one, and which session of others is joined.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

struct NetworkOptions {
  std::string interface;
  std::vector<std::string> peers;
  std::uint32_t domain = 0;
  std::string security;

  NetworkConfig config() const {
    return {.interface = interface, .peers = peers, .domain = domain, .security = security};
  }
};
/// --interface, --peer, --domain and --security.
void addNetworkOptions(Options& command, NetworkOptions& options);

/// What programs of ROS hear of a hand.
struct RosOptions {
  std::string name;  ///< of the namespace; empty: nothing
  double rate_Hz = 100;
};

struct JoinOptionsGiven {
  std::string name;  ///< empty: no session of others is joined
  std::string hand;  ///< what the others see this hand called; empty: as the machine
  bool near = false;  ///< the points around the hands alone
  RosOptions ros;    ///< on the same network
  NetworkOptions network;
};
enum class JoinAs { hand, onlooker };
/// --join, and those of the network; --as for a hand.
void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as);
/// --ros and --ros-rate.
void addRosOptions(Options& command, RosOptions& options);
/// What is joined, under whose name the model goes then; nothing where none is. `live`: what is given in place of a model
/// otherwise. Throws UsageError for options that do not go together.
std::optional<JoinConfig> joinConfig(const JoinOptionsGiven& options, std::string& modelFile,
                                     const std::string& live = {});

/// Joins sessions while nobody asks the program to end, as one more hand of this name.
SessionJoiner joiningHand(const std::string& hand);
/// The same of the points of a session as they are, to look at them.
SessionJoiner joiningOnlooker();
/// Hears clouds of ROS on that network while nobody asks the program to end.
CloudFetcher rosFetcher(const NetworkOptions& network);
/// Opens topics of ROS as streams, likewise. `threads`: for what comes without normals.
FrameWatcher rosWatcher(const NetworkOptions& network, unsigned threads);

}  // namespace palpate
