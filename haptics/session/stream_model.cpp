#include "haptics/session/stream_model.hpp"

#include <cstdio>
#include <utility>

#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"
#include "engine/io/depth_camera.hpp"
#include "engine/io/depth_pipe.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/motion/depth_points.hpp"
#include "engine/motion/depth_source.hpp"
#include "engine/motion/fused_playback.hpp"
#include "engine/motion/fused_source.hpp"

namespace palpate {

namespace {

constexpr std::string_view kStandardInput = "-";
constexpr int kMostSaid = 3;  // frames that are lost before the first good one: the others are not better

struct OpenedStream {
  std::shared_ptr<DepthStream> stream;
  std::optional<UpAxis> up = UpAxis::minusY;  ///< in the world of its poses; the camera's without
};

std::shared_ptr<DepthStream> openLive(const std::string& device, const StreamConfig& stream) {
  if (device == kStandardInput) {
    if (!stream.intrinsics.empty())
      throw ConfigError("stream.intrinsics", "raw frames say them in their first line; leave it out");
    return std::make_shared<DepthPipe>(::fileno(stdin), "standard input", stream.depthScale);
  }
  if (stream.intrinsics.empty())
    throw ConfigError("stream.intrinsics", "{} says none; give a JSON file with those of the camera", device);
  CameraText camera = readCamera(stream.intrinsics);
  if (stream.depthScale > 0) camera.depthScale = stream.depthScale;
  return openDepthCamera(device, camera);
}

/// False at the end.
bool readFrame(DepthStream& stream, DepthFrame& frame, Log& log) {
  for (int lost = 0;;) {
    try {
      return stream.next(frame);
    } catch (const Error& error) {
      if (++lost <= kMostSaid) log.say("{}", error.what());
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

/// Relative to an origin that lies near, as far from zero as the world may be.
PointCloud firstCloud(const DepthCamera& camera, const DepthFrame& frame) {
  CloudFrame points;
  makePoints(camera, frame, DVec3(0), points);
  const PointCloud coarse = cloudOf(points, DVec3(0));
  const DVec3 origin = coarse.empty() ? DVec3(0) : originFor(boundsOf(coarse));
  if (origin == DVec3(0)) return coarse;
  makePoints(camera, frame, origin, points);
  return cloudOf(points, origin);
}

/// As its map begins.
PointCloud firstMap(const DepthCamera& camera, const DepthFrame& frame) {
  FrameFusion fusion({});
  fusion.fuse(camera, frame);
  PointCloud cloud = fusion.map().cloud();
  cloud.storedAs.comments = {"comment units: m"};
  return cloud;
}

OpenedStream open(const SessionConfig& config, Log* log) {
  const StreamConfig& stream = *config.stream;
  if (stream.live) return {.stream = openLive(config.model.file, stream)};
  const auto folder = std::make_shared<RgbdFolder>(
      config.model.file, RgbdOptions{.intrinsics = stream.intrinsics, .depthScale = stream.depthScale}, log);
  return {.stream = folder, .up = folder->up()};
}

}  // namespace

FirstFrame readFirstFrame(const SessionConfig& config, Log& log) {
  const auto [stream, up] = open(config, &log);
  DepthFrame frame;
  FirstFrame first;
  while (first.cloud.empty()) {
    if (!readFrame(*stream, frame, log)) throw Error("{}: ends without a frame that has points", config.model.file);
    first.cloud = config.stream->fuse ? firstMap(stream->camera(), frame) : firstCloud(stream->camera(), frame);
  }
  if (frame.pose) first.camera = frustumOf(stream->camera(), *frame.pose);
  if (up) first.cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  if (!stream->isRecorded())
    first.live = std::make_shared<LiveFrames>(LiveFrames{.stream = stream, .first = std::move(frame)});
  return first;
}

std::unique_ptr<CloudSource> makeStreamSource(const SessionConfig& config, const Model& model) {
  const StreamConfig& stream = *config.stream;
  const PlayOptions options{.speed = stream.speed, .loop = stream.loop, .exact = !config.realtime};
  const auto played = [&](std::shared_ptr<DepthStream> frames,
                          std::optional<DepthFrame> first) -> std::unique_ptr<CloudSource> {
    // All frames that are due, whatever was asked for before, where nothing else bends their times.
    const bool plain = options.exact && stream.speed == 1 && !stream.loop;
    if (stream.fuse && plain) return std::make_unique<FusedSource>(std::move(frames), FusionOptions());
    if (stream.fuse)
      return std::make_unique<FusedPlayback>(std::move(frames), options, FusionOptions(), std::move(first));
    return std::make_unique<DepthSource>(std::move(frames), options, model.cloud.origin, std::move(first));
  };
  if (!model.live) return played(open(config, nullptr).stream, {});
  if (!model.live->stream) throw Error("{}: is played by another session", config.model.file);
  return played(std::exchange(model.live->stream, nullptr), std::move(model.live->first));
}

}  // namespace palpate
