// The configured motion of a session's model.
#pragma once

#include <memory>
#include <optional>

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// The rigid motion in model units, relative to the cloud's origin; empty if there is none.
std::optional<RigidMotion> rigidMotion(const SessionConfig& config, const Model& model);

/// Source that moves the points of the model on the host; null if they stand still. `stream`: the configuration's, if
/// it has one; its frames become a map if `fusion` is given.
std::unique_ptr<CloudSource> makeSource(const SessionConfig& config, const Model& model,
                                        const std::shared_ptr<PlayedStream>& stream,
                                        const std::optional<FusedStream>& fusion);

}  // namespace palpate
