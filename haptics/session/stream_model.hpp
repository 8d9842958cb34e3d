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

/// The cloud of the first frame that can be read and has points, in metres, with what is up; and what goes on behind it
/// (Model::stream). Waits for that frame. Throws FileError, Error.
struct FirstFrame {
  PointCloud cloud;
  std::shared_ptr<PlayedStream> stream;
  std::optional<CameraFrustum> camera;  ///< that took it; none where the frame does not say where it stood
};
FirstFrame readFirstFrame(const SessionConfig& config, const ModelLoading& loading);

/// The stream of the configuration, to be played behind the model's cloud: the one that the model has, held as it is,
/// or else the recording. Null where the configuration has none. Throws FileError, and Error where another session has
/// it.
std::shared_ptr<PlayedStream> takeStream(const SessionConfig& config, const Model& model);

/// How the frames of a stream that was taken become a map, which begins with the model's cloud; nothing where they do
/// not.
std::optional<FusedStream> fusedStream(const SessionConfig& config, const std::shared_ptr<const Model>& model,
                                       std::shared_ptr<PlayedStream> stream, unsigned threads, Log* log);

}  // namespace palpate
