// Options of what goes over a network: on which one, and which session of others is joined.
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
  std::string rosFrame;    ///< that what is heard of ROS is put in; empty: it stays in its own
  std::string colorTopic;  ///< of pictures of colour beside those of depth; empty: none are heard

  NetworkConfig config() const {
    return {.interface = interface, .peers = peers, .domain = domain, .security = security};
  }
};
/// --interface, --peer, --domain and --security.
void addNetworkOptions(Options& command, NetworkOptions& options);
/// --ros-frame, of commands that hear topics of ROS.
void addRosFrameOption(Options& command, NetworkOptions& options);
/// That, and --color-topic, of those that take live cameras.
void addRosCameraOptions(Options& command, NetworkOptions& options);
/// Throws UsageError where one of them is given, and `model` and `live` are no topics of ROS.
void checkRosHearing(const NetworkOptions& options, const std::string& model, const std::string& live = {});

/// Under which name programs of ROS hear something, and where its frame stands.
struct RosNameOptions {
  std::string name;          ///< of the namespace; empty: nothing
  std::string parent, pose;  ///< frame, and where in it

  /// Throws UsageError.
  void check() const;
  RosPublishing publishing(const NetworkOptions& network, double mm_per_unit) const;
};
/// --ros-parent and --ros-pose.
void addRosParentOptions(Options& command, RosNameOptions& options);

/// What programs of ROS hear of a hand.
struct RosOptions : RosNameOptions {
  double rate_Hz = 100;
};

struct JoinOptionsGiven {
  std::string name;   ///< empty: no session of others is joined
  std::string hand;   ///< what the others see this hand called; empty: as the machine
  bool near = false;  ///< the points around the hands alone
  RosOptions ros;     ///< on the same network
  NetworkOptions network;
};
enum class JoinAs { hand, onlooker };
/// --join, and those of the network; --as for a hand.
void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as);
/// --ros, --ros-rate, --ros-parent and --ros-pose.
void addRosOptions(Options& command, RosOptions& options);
/// What is joined, under whose name the model goes then; nothing where none is. `live`: what is given in place of a
/// model otherwise. Throws UsageError for options that do not go together.
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
