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
}

void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as) {
  command
      .add("--join", options.name, "in place of MODEL: a session that another palpate serves (palpate serve), by its name")
      .typeName("NAME");
  if (as == JoinAs::hand) {
    command.add("--as", options.hand, "what the others see this hand called (default: the machine's name)").typeName("NAME");
    command.addFlag("--near", options.near,
                    "of what is joined only the points around the hands come here, ahead of them: for models that are too large "
                    "to wait for; they are felt, and not sculpted. A model that moves is joined so in any case");
  }
  addNetworkOptions(command, options.network);
}

void addRosOptions(Options& command, RosOptions& options) {
  command
      .add("--ros", options.name,
           "programs of ROS 2 hear where the hand is (NAME/pose, NAME/proxy) and what it feels (NAME/wrench), on the "
           "network of --interface, --peer and --domain, else on this machine alone")
      .typeName("NAME");
  command.add("--ros-rate", options.rate_Hz, "Hz; ticks in between are left out")
      .check(between(1, bounds::kMostRate_Hz))
      .showDefault();
}

std::optional<JoinConfig> joinConfig(const JoinOptionsGiven& options, std::string& modelFile) {
  const NetworkOptions& network = options.network;
  if (!options.ros.name.empty()) requireRosName(options.ros.name);
  if (options.name.empty()) {
    const bool hasNetwork = !network.interface.empty() || !network.peers.empty() || network.domain != 0;
    const bool isUsed = isRosModel(modelFile) || !options.ros.name.empty();
    if ((hasNetwork && !isUsed) || !options.hand.empty() || options.near)
      throw UsageError(
          "--interface, --peer, --domain, --as and --near are for --join, which names a session (and but for --as and --near for ROS, too)");
    return std::nullopt;
  }
  if (!modelFile.empty()) throw UsageError("--join: the session that is joined is the model; leave {} out", modelFile);
  modelFile = options.name;
  return JoinConfig{.network = network.interface, .peers = network.peers, .domain = network.domain, .near = options.near};
}

namespace {

JoinedCloud join(const std::string& name, const JoinConfig& join, Log& log, bool present, const std::string& hand = {}) {
  const StopBySignal stop;
  JoinedCloud joined = joinCloud(name, {.network = {.interface = join.network, .peers = join.peers, .domain = join.domain},
                                        .present = present,
                                        .near = join.near,
                                        .hand = hand,
                                        .log = &log,
                                        .stop = &StopBySignal::requested()});
  if (joined.far)
    log.say("{}: of the {} points of {}, served by {}, those around the hands come here{}", name, joined.facts->extent.points,
            joined.model, joined.host, joined.facts->moves ? "; they move" : "");
  else
    log.say("{}: {} points of {}, served by {}", name, joined.cloud.size(), joined.model, joined.host);
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
    return hearRosCloud(name.substr(kRosModel.size()),
                        {.network = config, .log = &log, .stop = &StopBySignal::requested()});
  };
}

SessionJoiner sessionJoiner(const std::string& hand) {
  return [hand](const std::string& name, const JoinConfig& config, Log& log) {
    JoinedCloud joined = join(name, config, log, false, hand);
    JoinedModel model{.cloud = std::move(joined.cloud), .far = std::move(joined.far), .facts = joined.facts};
    if (joined.sculptable)
      model.share = [session = joined.session, hand, &log](const PointCloud& cloud, TouchBackend& backend) {
        return shareEdits({.session = session, .cloud = cloud, .backend = backend, .hand = hand, .log = &log});
      };
    return model;
  };
}

}  // namespace palpate
