// A depth camera as the model of a session: its stream, and its first frame as the cloud.
#pragma once

#include <memory>
#include <optional>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/motion/cloud_source.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

/// The cloud of the first frame that can be read and has points, in metres, with what is up; and of a live stream what
/// goes on behind it. Waits for that frame. Throws FileError, Error.
struct FirstFrame {
  PointCloud cloud;
  std::optional<CameraFrustum> camera;  ///< that took it; none where the frame does not say where it stood
  std::shared_ptr<LiveFrames> live;  ///< null where the stream is recorded
};
FirstFrame readFirstFrame(const SessionConfig& config, Log& log);

/// Plays the stream of the configuration. `model` was loaded with it; the stream of a live one goes to the first
/// session that asks.
std::unique_ptr<CloudSource> makeStreamSource(const SessionConfig& config, const Model& model);

}  // namespace palpate
