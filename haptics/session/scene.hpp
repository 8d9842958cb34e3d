// What a session touches: layers of points, with what their points have beside the model.
#pragma once

#include <array>
#include <memory>

#include "engine/core/vec.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// Pose of a layer in the scene: position = rotation * position in the layer + offset.
struct Placement {
  DQuat rotation{1, 0, 0, 0};  ///< unit
  DVec3 offset{0};             ///< model units

  DVec3 operator()(const DVec3& position) const { return rotation * position + offset; }
};

/// A model, and the masks and fields of its points.
struct Layer {
  std::shared_ptr<const Model> model;
  LayerAttributes attributes = {};
  Placement placement = {};
};

struct SessionScene {
  std::array<Layer, 1> layers;  ///< by PointState::layer
};

}  // namespace palpate
