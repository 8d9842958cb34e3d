// Annotations of pictures: a legend of the colours, and labels.
#pragma once

#include <string>

#include "engine/render/image.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/guides.hpp"

namespace palpate {

// Each reserves its room in the picture.

/// A ramp of colours at the right edge with its marks, or the colours of classes, under a heading.
void drawLegend(Image& image, const Legend& legend, LabelRoom& room);

/// Draws one line, its lower left corner at `at_px`, in a colour that contrasts with the background there.
void drawText(Image& image, const DVec2& at_px, const std::string& text, LabelRoom& room);

/// Draws one line on a plate that fits into the picture, its middle at `at_px` as far as possible, if there is room.
void drawLabel(Image& image, const PictureLabel& label, LabelRoom& room);

}  // namespace palpate
