// How a picture of a session's model is framed.
#pragma once

#include "engine/render/camera.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// What a picture of the model shows, with room for the discs of a few points.
Framing framingOf(const Model& model, UpAxis up);
/// The radius of all discs, model units, where the model says one, or its points have no spacing that would give them
/// one: all are in one place. 0 where discs have their own.
double discRadiusOf(const Model& model);

}  // namespace palpate
