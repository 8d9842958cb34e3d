// The model of a session that moves, as its configuration says.
#pragma once

#include <memory>
#include <optional>

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// In model units, relative to the cloud's origin; nothing where the model stands still.
std::optional<RigidMotion> rigidMotion(const SessionConfig& config, const Model& model);

/// What moves the points of the model on the host; null where it stands still. `stream`: the configuration's, if it has
/// one, which becomes a map where `fusion` says so.
std::unique_ptr<CloudSource> makeSource(const SessionConfig& config, const Model& model,
                                        const std::shared_ptr<PlayedStream>& stream,
                                        const std::optional<FusedStream>& fusion);

}  // namespace palpate
