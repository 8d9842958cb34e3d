#include "haptics/session/stream_model.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"
#include "engine/io/depth_camera.hpp"
#include "engine/io/depth_pipe.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_points.hpp"
#include "engine/motion/frame_fusion.hpp"

namespace palpate {

namespace {

constexpr std::string_view kStandardInput = "-";
constexpr int kMaxSaid = 3;  // number of reported losses before the first good frame: more would not help

struct OpenedStream {
  std::shared_ptr<DepthStream> stream;
  std::optional<UpAxis> up = UpAxis::minusY;  ///< in the world of its poses, or in the camera's axes without poses
  std::optional<UpAxis> worldUp = {};         ///< in place of that, if its frames have poses
  double mm_per_unit = 0;                     ///< of the session, unless configured otherwise; 0: fitting a hand
};

OpenedStream watchRos(const std::string& topic, const StreamConfig& stream, const ModelLoading& loading) {
  if (!loading.watch) throw Error("{}: ROS topics are not supported here", topic);
  std::optional<DepthCamera> intrinsics;
  if (!stream.intrinsics.empty()) intrinsics = readCamera(stream.intrinsics).camera;
  constexpr double kMmPerMetre = 1000;
  OpenedStream opened{.stream = loading.watch(topic, stream, intrinsics, loading.log),
                      .worldUp = UpAxis::z,  // REP 103, for all frames except a camera's
                      .mm_per_unit = kMmPerMetre};
  // The axes of point clouds are unknown; those of a picture are its camera's.
  if (!(opened.stream->camera().fx > 0)) opened.up.reset();
  return opened;
}

std::shared_ptr<DepthStream> openDevice(const std::string& device, const StreamConfig& stream) {
  if (device == kStandardInput) {
    if (!stream.intrinsics.empty())
      throw ConfigError("stream.intrinsics", "raw frames contain them in their first line; leave it out");
    return std::make_shared<DepthPipe>(::fileno(stdin), "standard input", stream.depthScale);
  }
  if (stream.intrinsics.empty())
    throw ConfigError("stream.intrinsics", "{} provides none; give a JSON file with those of the camera", device);
  CameraText camera = readCamera(stream.intrinsics);
  if (stream.depthScale > 0) camera.depthScale = stream.depthScale;
  return openDepthCamera(device, camera);
}

/// Returns false at the end of the stream.
bool readFrame(DepthStream& stream, DepthFrame& frame, Log& log) {
  for (int lost = 0;;) {
    try {
      return stream.next(frame);
    } catch (const Error& error) {
      if (++lost <= kMaxSaid) log.warn("{}", error.what());
    }
  }
}

PointCloud cloudOf(const CloudFrame& points, const DVec3& origin) {
  PointCloud cloud;
  cloud.origin = origin;
  placeAt(points, cloud);
  cloud.storedAs.comments = {"comment units: m"};
  return cloud;
}

/// Relative to an origin nearby, since the world may be far from zero.
PointCloud firstCloud(const DepthCamera& camera, const DepthFrame& frame) {
  CloudFrame points;
  DepthPoints maker;
  maker.make(camera, frame, DVec3(0), points);
  const PointCloud coarse = cloudOf(points, DVec3(0));
  const DVec3 origin = coarse.empty() ? DVec3(0) : originFor(boundsOf(coarse));
  if (origin == DVec3(0)) return coarse;
  maker.make(camera, frame, origin, points);
  return cloudOf(points, origin);
}

/// The initial map, and its camera pose.
FirstFrame firstMap(const DepthCamera& camera, const DepthFrame& frame) {
  FrameFusion fusion({});
  const FrameOutcome& outcome = fusion.fuse(camera, frame);
  FirstFrame first{.cloud = fusion.map().cloud(), .stream = std::make_shared<PlayedStream>()};
  first.cloud.storedAs.comments = {"comment units: m"};
  first.stream->behind = DepthPlayer::Place{.pass = 0, .time_s = frame.time_s};
  first.stream->seenFrom = outcome.pose;
  return first;
}

OpenedStream openLive(const ModelConfig& config, const ModelLoading& loading) {
  const std::string& name = config.file;
  if (isRosModel(name)) return watchRos(name, *config.stream, loading);
  return {.stream = openDevice(name, *config.stream)};
}

OpenedStream openFolder(const ModelConfig& config, Log* log) {
  const StreamConfig& stream = *config.stream;
  const auto folder = std::make_shared<RgbdFolder>(
      config.file, RgbdOptions{.intrinsics = stream.intrinsics, .depthScale = stream.depthScale}, log);
  return {.stream = folder, .up = folder->up()};
}

}  // namespace

FirstFrame readFirstFrame(const ModelConfig& config, const ModelLoading& loading) {
  Log& log = loading.log;
  const auto [stream, cameraUp, worldUp, mm_per_unit] =
      config.stream->live ? openLive(config, loading) : openFolder(config, &log);
  DepthFrame frame;
  FirstFrame first;
  while (first.cloud.empty()) {
    if (!readFrame(*stream, frame, log)) throw Error("{}: ends without a frame that has points", config.file);
    first = config.stream->fuse ? firstMap(stream->camera(), frame)
                                : FirstFrame{.cloud = firstCloud(stream->camera(), frame), .stream = nullptr};
  }
  if (frame.pose) first.camera = frustumOf(stream->camera(), *frame.pose);
  if (mm_per_unit > 0) sayScale(first.cloud.storedAs.comments, mm_per_unit);
  const std::optional<UpAxis> up = frame.pose && worldUp ? worldUp : cameraUp;
  if (up) first.cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  if (stream->isRecorded()) return first;
  const std::optional<CameraPose> seenFrom = first.stream ? first.stream->seenFrom : std::nullopt;
  first.stream = playedStream(stream, {.exact = false}, std::move(frame));
  first.stream->seenFrom = seenFrom;
  return first;
}

std::shared_ptr<PlayedStream> takeStream(const SessionConfig& config, const Model& model) {
  if (!config.model.stream) return nullptr;
  const StreamConfig& stream = *config.model.stream;
  PlayedStream* const behind = model.stream();
  if (behind && behind->player) {
    auto taken = std::make_shared<PlayedStream>(std::exchange(*behind, {}));
    taken->player->beginHere();
    return taken;
  }
  if (stream.live || (behind && !behind->behind)) throw Error("{}: is played by another session", config.model.file);
  const PlayOptions options{.speed = stream.speed, .loop = stream.loop, .exact = !config.realtime};
  auto opened = playedStream(openFolder(config.model, nullptr).stream, options);
  if (!behind) return opened;
  opened->player->beginBehind(*behind->behind);
  opened->seenFrom = behind->seenFrom;
  return opened;
}

std::optional<FusedStream> fusedStream(const SessionConfig& config, const std::shared_ptr<const Model>& model,
                                       std::shared_ptr<PlayedStream> stream, unsigned threads, Log* log) {
  if (!stream || !config.model.stream->fuse) return std::nullopt;
  FusedStream fused{.stream = std::move(stream), .begin = {model, &model->cloud}, .log = log};
  fused.options.capacity = std::max(fused.options.capacity, model->cloud.size());
  fused.options.threads = threads;
  return fused;
}

}  // namespace palpate
