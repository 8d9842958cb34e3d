// The letters of panels and pictures.
#pragma once

struct ImFontAtlas;

namespace palpate {

/// What the texels of an atlas are for: to be stretched over letters that may stand between pixels, or one for a pixel.
enum class Texels { fine, pixels };

/// Adds the font of this height to an atlas that has none yet; another one where it is not installed.
void addFont(ImFontAtlas& atlas, float height_px, Texels texels = Texels::fine);

}  // namespace palpate
