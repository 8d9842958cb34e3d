// Annotations of pictures: a legend of the heights, and the label of the scale bar.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/look.hpp"
#include "engine/render/image.hpp"

namespace palpate {

/// Ticks of a legend, at round heights in rising order, with their labels.
struct Tick {
  double height;
  std::string text;
};
std::vector<Tick> ticksOf(const HeightRange& heights);

/// A ramp of colours at the right edge with its ticks, headed by the unit.
void drawLegend(Image& image, const HeightRange& heights, LengthUnit unit);

/// Draws one line, its lower left corner at `at_px`, in a colour that contrasts with the background there.
void drawText(Image& image, const DVec2& at_px, const std::string& text);

}  // namespace palpate
