#include "apps/cli/stream_options.hpp"

#include "apps/cli/stop_by_signal.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/matter_scenes.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

void addDepthOptions(Options& command, StreamOptions& options) {
  command
      .add("--intrinsics", options.intrinsics,
           "intrinsics of the depth camera as JSON: width, height, fx, fy, cx, cy (pixels) or Open3D's "
           "intrinsic_matrix, and optionally depth_scale (default: those of the folder, or 640 x 480, "
           "525, 525, 319.5, 239.5)")
      .typeName("FILE.json");
  command
      .add("--depth-scale", options.depthScale,
           "depth values per metre (default: from the intrinsics, else 5000 for TUM folders and 1000 for "
           "others)")
      .check(between(bounds::kMinDepthScale, bounds::kMaxDepthScale));
}

void addStreamOptions(Options& command, StreamOptions& options) {
  command
      .add("--live", options.live,
           "live depth camera in place of MODEL: a V4L2 device with the format Z16, ros:TOPIC "
           "(PointCloud2, or depth Image with camera_info), or - for raw frames on standard input "
           "(format: apps/README.md)")
      .typeName("DEVICE|ros:TOPIC|-");
  command.add("--speed", options.speed, "playback speed of a recording; 1: as recorded")
      .check(between(bounds::kMinSpeed, bounds::kMaxSpeed))
      .showDefault();
  command.addFlag("--loop", options.loop, "restart a recording after its last frame");
  command
      .add("--fuse", options.fuse,
           "on: fuse the frames into one map that is felt while it grows; off: feel the newest frame "
           "only")
      .check(oneOf({"on", "off"}))
      .showDefault();
  addDepthOptions(command, options);
}

std::string modelsAndStreams(RosModels ros) {
  const char* topic = ros == RosModels::none ? ""
                      : ros == RosModels::clouds
                          ? "; or ros:TOPIC, the first PointCloud2 of a ROS 2 topic"
                          : "; or ros:TOPIC, the first PointCloud2 or the live depth pictures of a ROS 2 topic";
  return fmt::format("a {} file; a recording of a depth camera, {}; a simulated scene, .json or {}{}",
                     cloudFormats().namesRead(), rgbdFoldersRead(), builtInScenes(), topic);
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
  StreamConfig stream{.speed = options.speed,
                      .loop = options.loop,
                      .fuse = options.fuse == "on",
                      .depthScale = options.depthScale,
                      .intrinsics = options.intrinsics};
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
        "that is {}",
        modelFile, rgbdFoldersRead());
  return std::nullopt;
}

}  // namespace palpate
