// Options of the network, and of the session to join.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/sharing/network.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

struct NetworkOptions {
  std::string interface;
  std::vector<std::string> peers;
  std::uint32_t domain = 0;
  std::string security;
  std::string rosFrame;    ///< frame for data received from ROS; empty: that of the messages
  std::string colorTopic;  ///< colour pictures beside the depth pictures; empty: none

  NetworkConfig config() const {
    return {.interface = interface, .peers = peers, .domain = domain, .security = security};
  }
};
/// --interface, --peer, --domain and --security.
void addNetworkOptions(Options& command, NetworkOptions& options);
/// --ros-frame, for commands that subscribe to ROS topics.
void addRosFrameOption(Options& command, NetworkOptions& options);
/// The same and --color-topic, for commands that accept live cameras.
void addRosCameraOptions(Options& command, NetworkOptions& options);
/// Throws UsageError if one of them is given, but neither `model` nor `live` is a ROS topic.
void checkRosHearing(const NetworkOptions& options, const std::string& model, const std::string& live = {});

/// Name under which data are published for ROS, and the pose of their frame.
struct RosNameOptions {
  std::string name;          ///< the namespace; empty: nothing is published
  std::string parent, pose;  ///< parent frame, and pose in it

  /// Throws UsageError.
  void check() const;
  RosPublishing publishing(const NetworkOptions& network, double mm_per_unit) const;
};
/// --ros-parent and --ros-pose.
void addRosParentOptions(Options& command, RosNameOptions& options);

/// Publishing of a hand for ROS.
struct RosOptions : RosNameOptions {
  double rate_Hz = 100;
};

struct JoinOptionsGiven {
  std::string name;      ///< empty: no session is joined
  std::string hand;      ///< name of this hand for the others; empty: that of the machine
  bool partial = false;  ///< fetches only the points around the hands
  RosOptions ros;        ///< on the same network
  NetworkOptions network;
};
enum class JoinAs { hand, onlooker };
/// --join and the network options; --hand-name and --partial for a hand.
void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as);
/// --ros, --ros-rate, --ros-parent and --ros-pose.
void addRosOptions(Options& command, RosOptions& options);
/// The session to join, whose name becomes that of the model; empty if none is joined. `live`: camera given in place of
/// a model. Throws UsageError for incompatible options.
std::optional<JoinConfig> joinConfig(const JoinOptionsGiven& options, std::string& modelFile,
                                     const std::string& live = {});

/// Joins sessions as one more hand of this name, unless a stop is requested.
SessionJoiner joiningHand(const std::string& hand);
/// The same for the present points of a session, for display only.
SessionJoiner joiningOnlooker();
/// Receives ROS clouds on that network, unless a stop is requested.
CloudFetcher rosFetcher(const NetworkOptions& network);
/// Opens ROS topics as streams, likewise. `threads`: for estimating missing normals.
FrameWatcher rosWatcher(const NetworkOptions& network, unsigned threads);

}  // namespace palpate
