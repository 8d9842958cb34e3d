// A depth stream that is fused into a map, and handed from one session to the next.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/motion/depth_player.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// A depth stream that is played, with what is needed to continue it behind a cloud made of it. It has one owner at a
/// time: taking it leaves the previous owner without player, so without further frames.
struct PlayedStream {
  std::unique_ptr<DepthPlayer> player;  ///< null: another owner plays it, or the recording is not open yet
  /// For a recording that is not played yet: the frame that the cloud was made of.
  std::optional<DepthPlayer::Place> behind;
  /// Pose of the newest frame in the cloud; nothing: there is none.
  std::optional<CameraPose> seenFrom;
};

/// Wraps a stream that was not played yet. Throws nothing; `first` as for DepthPlayer.
inline std::shared_ptr<PlayedStream> playedStream(std::shared_ptr<DepthStream> stream, const PlayOptions& options = {},
                                                  std::optional<DepthFrame> first = {}) {
  auto played = std::make_shared<PlayedStream>();
  played->player = std::make_unique<DepthPlayer>(std::move(stream), options, std::move(first));
  return played;
}

/// Depth frames to be fused, on the host or on the GPU, into a map that begins with the points of a cloud, which count
/// as stable. `log`, if any, must outlive the fusion.
struct FusedStream {
  std::shared_ptr<PlayedStream> stream;
  std::shared_ptr<const PointCloud> begin;  ///< with normals; its origin is the map's. Null: an empty map
  FusionOptions options;
  IcpOptions icp;
  Log* log = nullptr;
};

}  // namespace palpate
