#include "apps/cli/sharing_options.hpp"

#include "apps/cli/stop_by_signal.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/session_joiner.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

void addNetworkOptions(Options& command, NetworkOptions& options) {
  command
      .add("--interface", options.interface,
           "the network that is used: an interface of this machine, by name or address (default: programs of this "
           "machine alone)")
      .typeName("NAME|ADDRESS");
  command
      .add("--peer", options.peers,
           "address of a machine to look for, where the network carries no multicast; as often as there are some")
      .typeName("ADDRESS");
  command.add("--domain", options.domain, "of DDS, as ROS numbers them").check(inRange(0, bounds::kLastDomain)).showDefault();
  command
      .add("--security", options.security,
           "a folder of keys (palpate keys): all is encrypted, and only holders of keys of the same authority find, join "
           "and hear it")
      .typeName("FOLDER");
}

void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as) {
  command
      .add("--join", options.name, "in place of MODEL: a session that another palpate serves (palpate serve), by its name")
      .typeName("NAME");
  if (as == JoinAs::hand) {
    command.add("--as", options.hand, "what the others see this hand called (default: the machine's name)").typeName("NAME");
    command.addFlag("--near", options.near,
                    "of what is joined only the points around the hands come here, ahead of them: for models that are too large "
                    "to wait for; they are felt and sculpted, but nothing is saved, and strokes are not taken back. A model that moves is "
                    "joined so in any case, and is felt alone");
  }
  addNetworkOptions(command, options.network);
}

void addRosOptions(Options& command, RosOptions& options) {
  command
      .add("--ros", options.name,
           "programs of ROS 2 hear where the hand is (NAME/pose, NAME/proxy) and what it feels (NAME/wrench), on the "
           "network of --interface, --peer, --domain and --security, else on this machine alone")
      .typeName("NAME");
  command.add("--ros-rate", options.rate_Hz, "Hz; ticks in between are left out")
      .check(between(1, bounds::kMostRate_Hz))
      .showDefault();
}

std::optional<JoinConfig> joinConfig(const JoinOptionsGiven& options, std::string& modelFile, const std::string& live) {
  const NetworkOptions& network = options.network;
  if (!options.ros.name.empty()) requireRosName(options.ros.name);
  if (options.name.empty()) {
    const bool hasNetwork = !network.interface.empty() || !network.peers.empty() || network.domain != 0 || !network.security.empty();
    const bool isUsed = isRosModel(modelFile) || isRosModel(live) || !options.ros.name.empty();
    if ((hasNetwork && !isUsed) || !options.hand.empty() || options.near)
      throw UsageError(
          "--interface, --peer, --domain, --security, --as and --near are for --join, which names a session (and but for --as and --near for ROS, too)");
    return std::nullopt;
  }
  if (!modelFile.empty()) throw UsageError("--join: the session that is joined is the model; leave {} out", modelFile);
  modelFile = options.name;
  return JoinConfig{.network = network.interface,
                    .peers = network.peers,
                    .domain = network.domain,
                    .security = network.security,
                    .near = options.near};
}

namespace {

// Whatever is fetched over a network ends when somebody asks the program to.
SessionJoiner stoppable(SessionJoiner joiner) {
  return [joiner = std::move(joiner)](const std::string& name, const JoinConfig& config, Log& log) {
    const StopBySignal stop;
    return joiner(name, config, log);
  };
}

}  // namespace

SessionJoiner joiningHand(const std::string& hand) {
  return stoppable(sessionJoiner({.hand = hand, .stop = &StopBySignal::requested()}));
}

SessionJoiner joiningOnlooker() { return stoppable(pointsJoiner({.stop = &StopBySignal::requested()})); }

CloudFetcher rosFetcher(const NetworkOptions& network) {
  return [config = network.config()](const std::string& name, Log& log) {
    const StopBySignal stop;
    return hearRosCloud(rosTopicOf(name), {.network = config, .log = &log, .stop = &StopBySignal::requested()});
  };
}

FrameWatcher rosWatcher(const NetworkOptions& network, unsigned threads) {
  return [config = network.config(), threads](const std::string& name, const StreamConfig& stream,
                                              const std::optional<DepthCamera>& intrinsics, Log& log) {
    const StopBySignal stop;
    return watchRosFrames(rosTopicOf(name),
                          {.listening = {.network = config, .log = &log, .stop = &StopBySignal::requested()},
                           .camera = intrinsics,
                           .depthScale = stream.depthScale,
                           .needsPictures = stream.fuse,
                           .threads = threads});
  };
}

}  // namespace palpate
