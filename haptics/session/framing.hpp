// Framing and look of a picture of a session's model.
#pragma once

#include <string>

#include "engine/render/camera.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/light_config.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// The part of the model that a picture shows, with room for the discs of a few points.
Framing framingOf(const Model& model, UpAxis up);
/// The common radius of all discs, model units, if the model has one, or if its points have no spacing because all are
/// at one position. 0 if each disc has its own.
double discRadiusOf(const Model& model);
/// What every picture of the model begins with, in the window, in files and in the library. `field`: colours the
/// points; null: the source of `color` does.
FrameOptions frameOptionsOf(const Model& model, UpAxis up, const ColorConfig& color, const ColoredField* field,
                            const LightConfig& light, const LightFor& picture);
/// That the pictures show no surface from its back, if that was not chosen but found: else empty.
std::string hiddenBacksNote(const Model& model, const LightConfig& light);

}  // namespace palpate
