// A depth camera as the model of a session: its stream, and its first frame as the cloud.
#pragma once

#include <memory>
#include <optional>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/motion/fused_stream.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

/// The cloud of the first readable frame with points, in metres, with the up axis; and the stream that continues behind
/// it (Model::stream). Waits for that frame. Throws FileError, Error.
struct FirstFrame {
  PointCloud cloud;
  std::shared_ptr<PlayedStream> stream;
  std::optional<CameraFrustum> camera;  ///< that took it; empty if the frame has no pose
};
FirstFrame readFirstFrame(const ModelConfig& config, const ModelLoading& loading);

/// The configured stream, to be played behind the model's cloud: that of the model, in its paused state, or else the
/// recording. Null if none is configured. Throws FileError, and Error if another session plays it.
std::shared_ptr<PlayedStream> takeStream(const SessionConfig& config, const Model& model);

/// How the frames of a taken stream are fused into a map, which begins with the model's cloud; empty if they are not.
std::optional<FusedStream> fusedStream(const SessionConfig& config, const std::shared_ptr<const Model>& model,
                                       std::shared_ptr<PlayedStream> stream, unsigned threads, Log* log);

}  // namespace palpate
