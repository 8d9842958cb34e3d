// What is written into a picture: which colour stands for which height, and how long a scale bar is.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/look.hpp"
#include "engine/render/image.hpp"

namespace palpate {

/// The heights at the ticks of a legend, round ones, in rising order, with what is written beside them.
struct Tick {
  double height;
  std::string text;
};
std::vector<Tick> ticksOf(const HeightRange& heights);

/// A ramp of colours at the right edge with its ticks, headed by the unit.
void drawLegend(Image& image, const HeightRange& heights, LengthUnit unit);

/// One line, its lower left corner at `at_px`, in what stands out there.
void drawText(Image& image, const DVec2& at_px, const std::string& text);

}  // namespace palpate
