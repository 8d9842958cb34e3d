// The letters of panels and pictures.
#pragma once

struct ImFontAtlas;

namespace palpate {

/// Adds the font of this height to an atlas that has none yet; another one where it is not installed.
void addFont(ImFontAtlas& atlas, float height_px);

}  // namespace palpate
