// The letters of panels and pictures.
#pragma once

#include <span>

struct ImFontAtlas;

namespace palpate {

/// What the texels of an atlas are for: to be stretched over letters that may stand between pixels, or one for a pixel.
enum class Texels { fine, pixels };

/// Gives an atlas the font of this height, in the place of any other, and builds it; another one where it is not
/// installed. `letters`: pairs of the first and the last one, and a zero, which must stay where they are; Latin ones
/// where there are none. Those that the font lacks come from others that are installed.
void addFont(ImFontAtlas& atlas, float height_px, Texels texels = Texels::fine,
             std::span<const unsigned short> letters = {});

}  // namespace palpate
