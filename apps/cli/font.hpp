// Fonts of panels and pictures.
#pragma once

#include <span>

struct ImFontAtlas;

namespace palpate {

/// Use of the texels of an atlas: `fine` ones are stretched over letters that may stand between pixels; `pixels` are
/// one texel per pixel.
enum class Texels { fine, pixels };

/// Replaces the fonts of an atlas by the font of this height, or another one if it is not installed, and builds it.
/// `letters`: pairs of the first and the last letter, and a zero, which must outlive the atlas; empty: Latin letters.
/// Letters missing in the font come from other installed ones.
void addFont(ImFontAtlas& atlas, float height_px, Texels texels = Texels::fine,
             std::span<const unsigned short> letters = {});

}  // namespace palpate
