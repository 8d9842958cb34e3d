#include "apps/cli/sharing_options.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cli/parse_list.hpp"
#include "apps/cli/setting_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/sharing/session_joiner.hpp"

namespace palpate {

void addNetworkOptions(Options& command, NetworkOptions& options) {
  addSettingFor<JoinConfig>(command, options.interface, "network").typeName("NAME|ADDRESS");
  addSettingFor<JoinConfig>(command, options.peers, "peers").typeName("ADDRESS");
  addSettingFor<JoinConfig>(command, options.domain, "domain").showDefault();
  addSettingFor<JoinConfig>(command, options.security, "security").typeName("FOLDER");
}

void addRosFrameOption(Options& command, NetworkOptions& options) {
  command
      .add("--ros-frame", options.rosFrame,
           "transform points from ros:TOPIC into this frame, with /tf_static and /tf (default: the frame "
           "of the messages)")
      .typeName("FRAME");
}

void addRosCameraOptions(Options& command, NetworkOptions& options) {
  addRosFrameOption(command, options);
  command
      .add("--color-topic", options.colorTopic,
           "colour pictures (rgb8, bgr8) registered with the depth pictures of ros:TOPIC, of the same "
           "size")
      .typeName("TOPIC");
}

void checkRosHearing(const NetworkOptions& options, const std::string& model, const std::string& live) {
  if (options.rosFrame.empty() && options.colorTopic.empty()) return;
  if (!isRosModel(model) && !isRosModel(live))
    throw UsageError("--ros-frame and --color-topic: require a ROS topic (ros:TOPIC) as the model");
  if (!options.rosFrame.empty()) requireRosFrame(options.rosFrame);
  if (!options.colorTopic.empty()) requireRosName(options.colorTopic);
}

void addJoinOptions(Options& command, JoinOptionsGiven& options, JoinAs as) {
  command.add("--join", options.name, "join a session served by palpate serve, by its name, in place of MODEL")
      .typeName("NAME");
  if (as == JoinAs::hand) {
    command
        .add("--hand-name", options.hand,
             "name of this hand for the other participants (default: the name of this machine)")
        .typeName("NAME");
    addSettingFor<JoinConfig>(command, options.partial, "partial");
  }
  addNetworkOptions(command, options.network);
  addRosCameraOptions(command, options.network);
}

void addRosParentOptions(Options& command, RosNameOptions& options) {
  command
      .add("--ros-parent", options.parent,
           "with --ros: parent frame of the frame NAME, published on /tf_static (default: not published)")
      .typeName("FRAME");
  command
      .add("--ros-pose", options.pose,
           "pose of the frame NAME in its parent: metres and a unit quaternion (default 0,0,0,1,0,0,0)")
      .typeName("X,Y,Z[,QW,QX,QY,QZ]");
}

namespace {

CameraPose poseIn(const std::string& text) {
  constexpr const char* kWanted = "X,Y,Z in metres, or X,Y,Z,QW,QX,QY,QZ with a unit quaternion";
  constexpr double kFarthest_m = 1e9, kUnit = 1e-3;
  std::string all = text;
  if (std::ranges::count(text, ',') == 2) all += ",1,0,0,0";
  const auto [x, y, z, qw, qx, qy, qz] = parseList<double, 7>(all, ',', "--ros-pose", kWanted);
  const DQuat turn(qw, qx, qy, qz);
  if (!(std::abs(glm::length(turn) - 1) < kUnit) || !(glm::length(DVec3(x, y, z)) <= kFarthest_m))
    throw UsageError("--ros-pose: '{}' is not {}", text, kWanted);
  return {.turn = glm::normalize(turn), .centre = DVec3(x, y, z)};
}

}  // namespace

void RosNameOptions::check() const {
  if (!name.empty()) requireRosName(name);
  if (name.empty() && !parent.empty()) throw UsageError("--ros-parent: requires --ros, which names the frame");
  if (parent.empty() && !pose.empty())
    throw UsageError("--ros-pose: requires --ros-parent, which names the parent frame");
  if (!parent.empty()) requireRosParent(parent, name);
  if (!pose.empty()) poseIn(pose);
}

RosPublishing RosNameOptions::publishing(const NetworkOptions& network, double mm_per_unit) const {
  return {.network = network.config(),
          .name = name,
          .mm_per_unit = mm_per_unit,
          .parent = parent,
          .inParent = pose.empty() ? CameraPose{} : poseIn(pose)};
}

void addRosOptions(Options& command, RosOptions& options) {
  command
      .add("--ros", options.name,
           "publish the hand for ROS 2: NAME/pose, NAME/proxy, NAME/wrench and the frame NAME/hand; "
           "network as for --interface, --peer, --domain and --security")
      .typeName("NAME");
  command.add("--ros-rate", options.rate_Hz, "publishing rate, Hz; ticks in between are skipped")
      .check(between(1, bounds::kMaxRate_Hz))
      .showDefault();
  addRosParentOptions(command, options);
}

std::optional<JoinConfig> joinConfig(const JoinOptionsGiven& options, std::string& modelFile, const std::string& live) {
  const NetworkOptions& network = options.network;
  options.ros.check();
  checkRosHearing(network, modelFile, live);
  if (options.name.empty()) {
    const bool hasNetwork =
        !network.interface.empty() || !network.peers.empty() || network.domain != 0 || !network.security.empty();
    const bool isUsed = isRosModel(modelFile) || isRosModel(live) || !options.ros.name.empty();
    if ((hasNetwork && !isUsed) || !options.hand.empty() || options.partial)
      throw UsageError(
          "--interface, --peer, --domain and --security require --join, --ros or a ROS topic as the model; --hand-name "
          "and "
          "--partial "
          "require --join");
    return std::nullopt;
  }
  if (!modelFile.empty()) throw UsageError("--join: the joined session is the model; leave {} out", modelFile);
  modelFile = options.name;
  return JoinConfig{.network = network.interface,
                    .peers = network.peers,
                    .domain = network.domain,
                    .security = network.security,
                    .partial = options.partial};
}

namespace {

bool isAskedToEnd() { return StopBySignal::requested(); }

// A stop request cancels fetching over a network.
SessionJoiner stoppable(SessionJoiner joiner) {
  return [joiner = std::move(joiner)](const std::string& name, const JoinConfig& config, Log& log) {
    const StopBySignal stop;
    return joiner(name, config, log);
  };
}

}  // namespace

SessionJoiner joiningHand(const std::string& hand) {
  return stoppable(sessionJoiner({.hand = hand, .stop = isAskedToEnd}));
}

SessionJoiner joiningOnlooker() { return stoppable(pointsJoiner({.stop = isAskedToEnd})); }

CloudFetcher rosFetcher(const NetworkOptions& network) {
  return [config = network.config(), frame = network.rosFrame](const std::string& name, Log& log) {
    const StopBySignal stop;
    return hearRosCloud(rosTopicOf(name),
                        {.network = config, .frame = frame, .log = &log, .stop = &StopBySignal::requested()});
  };
}

FrameWatcher rosWatcher(const NetworkOptions& network, unsigned threads) {
  return
      [config = network.config(), frame = network.rosFrame, colorTopic = network.colorTopic, threads](
          const std::string& name, const StreamConfig& stream, const std::optional<DepthCamera>& intrinsics, Log& log) {
        const StopBySignal stop;
        return watchRosFrames(
            rosTopicOf(name),
            {.listening = {.network = config, .frame = frame, .log = &log, .stop = &StopBySignal::requested()},
             .camera = intrinsics,
             .depthScale = stream.depthScale,
             .colorTopic = colorTopic,
             .needsPictures = stream.fuse,
             .threads = threads});
      };
}

}  // namespace palpate
