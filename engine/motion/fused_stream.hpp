// A depth stream on its way into a map, and from one session to the next.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/motion/depth_player.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// A depth stream that is played, and what has to be known to go on with it behind a cloud that was made of it. It has
/// one owner at a time: who takes it leaves it empty, and whoever played it before has no more frames.
struct PlayedStream {
  std::unique_ptr<DepthPlayer> player;  ///< null: another one plays it, or is to open the recording
  /// Of a recording that nobody plays yet: the frame that the cloud was made of.
  std::optional<DepthPlayer::Place> behind;
  /// From where the newest frame that is in the cloud was seen; nothing: there is none.
  std::optional<CameraPose> seenFrom;
};

/// Of a stream that nobody has played yet. Throws nothing; `first` as for DepthPlayer.
inline std::shared_ptr<PlayedStream> playedStream(std::shared_ptr<DepthStream> stream, const PlayOptions& options = {},
                                                  std::optional<DepthFrame> first = {}) {
  auto played = std::make_shared<PlayedStream>();
  played->player = std::make_unique<DepthPlayer>(std::move(stream), options, std::move(first));
  return played;
}

/// Depth frames that are to be fused, on the host or on the GPU: into a map that begins with the points of a cloud,
/// which count as measured often enough. `log`, if any, outlives what fuses them.
struct FusedStream {
  std::shared_ptr<PlayedStream> stream;
  std::shared_ptr<const PointCloud> begin;  ///< with normals; its origin is the map's. Null: no point
  FusionOptions options;
  IcpOptions icp;
  Log* log = nullptr;
};

}  // namespace palpate
