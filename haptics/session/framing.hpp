// Framing of a picture of a session's model.
#pragma once

#include "engine/render/camera.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// The part of the model that a picture shows, with room for the discs of a few points.
Framing framingOf(const Model& model, UpAxis up);
/// The common radius of all discs, model units, if the model has one, or if its points have no spacing because all are
/// at one position. 0 if each disc has its own.
double discRadiusOf(const Model& model);

}  // namespace palpate
