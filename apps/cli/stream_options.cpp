#include "apps/cli/stream_options.hpp"

#include "apps/cli/setting_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

void addDepthOptions(Options& command, StreamOptions& options) {
  addSetting(command, options.stream, "intrinsics").typeName("FILE.json");
  addSetting(command, options.stream, "depth_scale");
}

void addStreamOptions(Options& command, StreamOptions& options) {
  addSettingFor<StreamConfig>(command, options.live, "live").typeName("DEVICE|ros:TOPIC|-");
  addSetting(command, options.stream, "speed").showDefault();
  addSetting(command, options.stream, "loop");
  addSettingFor<StreamConfig>(command, options.fuse, "fuse").check(oneOf({"on", "off"})).showDefault();
  addDepthOptions(command, options);
}

std::string modelsAndStreams(RosModels ros) {
  const char* topic = ros == RosModels::none ? ""
                      : ros == RosModels::clouds
                          ? "; or ros:TOPIC, the first PointCloud2 of a ROS 2 topic"
                          : "; or ros:TOPIC, the first PointCloud2 or the live depth pictures of a ROS 2 topic";
  const std::string scenes = canSimulate() ? "; a simulated scene, .json or " + builtInScenes() : std::string();
  return fmt::format("a {} file; a recording of a depth camera, {}{}{}", cloudFormats().namesRead(), rgbdFoldersRead(),
                     scenes, topic);
}

namespace {

bool isRosCamera(const std::string& modelFile, const RosQuestion& ros) {
  const StopBySignal stop;
  return whatRosSends(rosTopicOf(modelFile),
                      {.network = ros.network.config(), .log = &ros.log, .stop = &StopBySignal::requested()}) ==
         RosContent::pictures;
}

}  // namespace

std::optional<StreamConfig> streamConfig(const StreamOptions& options, std::string& modelFile, const RosQuestion* ros) {
  StreamConfig stream = options.stream;
  stream.fuse = options.fuse == "on";
  if (!options.live.empty()) {
    if (!modelFile.empty()) throw UsageError("--live: the camera is the model; leave {} out", modelFile);
    modelFile = options.live;
    stream.live = true;
    return stream;
  }
  if (modelFile.empty()) throw UsageError("model: is required; name a file, or a camera with --live");
  if (isRgbdFolder(modelFile)) return stream;
  if (ros && isRosModel(modelFile)) stream.live = isRosCamera(modelFile, *ros);
  if (stream.live) return stream;
  if (stream != StreamConfig{})
    throw UsageError(
        "{}: is not a recorded depth camera, which --speed, --loop, --fuse, --depth-scale and --intrinsics require; "
        "name {}",
        modelFile, rgbdFoldersRead());
  return std::nullopt;
}

void setSource(ModelConfig& model, const StreamOptions& options, const RosQuestion* ros) {
  model.stream = streamConfig(options, model.file, ros);
  if (!model.stream) model.matter = sceneNamed(model.file);
}

ModelConfig chosenModel(const ModelOptions& options, const StreamOptions& stream, const JoinOptionsGiven& join,
                        Log& log) {
  ModelConfig model = options.config();
  model.join = joinConfig(join, model.file, stream.live);
  const RosQuestion ros{join.network, log};
  if (!model.join) setSource(model, stream, &ros);
  std::string joined = "--join " + model.file;
  if (model.join) streamConfig(stream, joined);  // refuses the options of a stream
  return model;
}

}  // namespace palpate
