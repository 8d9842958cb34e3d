#include "apps/cli/sharing_options.hpp"

#include "apps/cli/stop_by_signal.hpp"
#include "engine/cloud/length_unit.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/shared_edits.hpp"

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
  if (as == JoinAs::hand)
    command.add("--as", options.hand, "what the others see this hand called (default: the machine's name)").typeName("NAME");
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
    if ((hasNetwork && !isUsed) || !options.hand.empty())
      throw UsageError(
          "--interface, --peer, --domain, --security and --as are for --join, which names a session (and but for --as for ROS, too)");
    return std::nullopt;
  }
  if (!modelFile.empty()) throw UsageError("--join: the session that is joined is the model; leave {} out", modelFile);
  modelFile = options.name;
  return JoinConfig{
      .network = network.interface, .peers = network.peers, .domain = network.domain, .security = network.security};
}

namespace {

JoinedCloud join(const std::string& name, const JoinConfig& join, Log& log, bool present) {
  const StopBySignal stop;
  const NetworkConfig network{
      .interface = join.network, .peers = join.peers, .domain = join.domain, .security = join.security};
  JoinedCloud joined = joinCloud(name, {.network = network,
                                        .present = present,
                                        .log = &log,
                                        .stop = &StopBySignal::requested()});
  log.say("{}: {} points of {}, served by {}; {}", name, joined.cloud.size(), joined.model, joined.host, opennessOf(network));
  sayScale(joined.cloud.storedAs.comments, joined.mm_per_unit);
  return joined;
}

}  // namespace

SessionJoiner pointsJoiner() {
  return [](const std::string& name, const JoinConfig& config, Log& log) {
    return JoinedModel{.cloud = join(name, config, log, true).cloud};
  };
}

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

SessionJoiner sessionJoiner(const std::string& hand) {
  return [hand](const std::string& name, const JoinConfig& config, Log& log) {
    JoinedCloud joined = join(name, config, log, false);
    JoinedModel model{.cloud = std::move(joined.cloud)};
    if (!joined.sculptable)
      log.say("{}: it is served to be felt alone; nothing of it changes, so that it is felt whether or not the link holds", name);
    if (joined.sculptable)
      model.share = [session = joined.session, hand, &log](const PointCloud& cloud, TouchBackend& backend) {
        return shareEdits({.session = session, .cloud = cloud, .backend = backend, .hand = hand, .log = &log});
      };
    return model;
  };
}

}  // namespace palpate
