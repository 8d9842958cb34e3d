// Scenes of matter as models of a session.
#pragma once

#include <memory>

#include "engine/matter/matter_model.hpp"
#include "engine/matter/soft_model.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// The initial state of a scene. Throws Error.
Model sceneModel(const MatterScene& scene, const ModelConfig& config, const ModelLoading& loading);

/// The body that stands in a scene of water or sand: reads its file or samples its shape, and computes a field. Null if
/// there is none. Throws FileError, and Error if the body is not closed.
std::shared_ptr<const MatterModel> standingModel(const MatterScene& scene, const ModelLoading& loading);

/// The body that stands in the model's matter; null if there is none.
std::shared_ptr<const MatterModel> standingOf(const Model& model);
/// The soft body of the model; null if it is none.
std::shared_ptr<const SoftModel> softBodyOf(const Model& model);

}  // namespace palpate
