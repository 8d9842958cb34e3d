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
           "of a depth camera: width, height, fx, fy, cx, cy in pixels, or Open3D's intrinsic_matrix, and depth_scale "
           "where "
           "it is known (default: the folder's own, or 640 x 480, 525, 525, 319.5, 239.5)")
      .typeName("FILE.json");
  command
      .add("--depth-scale", options.depthScale,
           "depth values per metre (default: as the intrinsics say, or 5000 of a TUM folder and 1000 of others)")
      .check(between(bounds::kMinDepthScale, bounds::kMaxDepthScale));
}

void addStreamOptions(Options& command, StreamOptions& options) {
  command
      .add(
          "--live", options.live,
          "in place of MODEL: a V4L2 device that speaks Z16, as /dev/video2, with --intrinsics; ros:TOPIC, each "
          "message of "
          "a topic of ROS 2 (PointCloud2, or Image of depth with its camera_info); or -, raw frames on "
          "standard input: one line of JSON (width height fx fy cx cy depth_scale, format z16 or z16+rgb8, pose), then "
          "frames, each a line 'frame TIME_S [16 numbers, camera to world]' and its bytes")
      .typeName("DEVICE|ros:TOPIC|-");
  command.add("--speed", options.speed, "of a recording: its seconds in one second")
      .check(between(bounds::kMinSpeed, bounds::kMaxSpeed))
      .showDefault();
  command.addFlag("--loop", options.loop, "a recording begins again after its last frame");
  command
      .add(
          "--fuse", options.fuse,
          "on: the frames of a depth camera become one map, which is felt and seen while it grows, on the GPU with the "
          "back end vulkan; off: the newest frame is the cloud")
      .check(oneOf({"on", "off"}))
      .showDefault();
  addDepthOptions(command, options);
}

std::string modelsAndStreams(RosModels ros) {
  const char* topic =
      ros == RosModels::none ? ""
      : ros == RosModels::clouds
          ? ", or a topic of ROS 2 (ros:TOPIC: the first PointCloud2)"
          : ", or a topic of ROS 2 (ros:TOPIC: the first PointCloud2, or a camera's live pictures of depth)";
  return fmt::format("{} file, a recorded depth camera ({}), a scene of matter (a .json file, or one of {}){}",
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
        "{}: is no recorded depth camera, which --speed, --loop, --fuse, --depth-scale and --intrinsics are for; "
        "that is {}",
        modelFile, rgbdFoldersRead());
  return std::nullopt;
}

}  // namespace palpate
