#include "apps/cli/font.hpp"

#include <imgui.h>

#include "apps/cli/system_places.hpp"

namespace palpate {

void addFont(ImFontAtlas& atlas, float height_px, Texels texels) {
  ImFontConfig config;
  if (texels == Texels::pixels) {
    config.OversampleH = config.OversampleV = 1;
    config.PixelSnapH = true;
  }
  const std::filesystem::path file = fontFile();
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored))
    atlas.AddFontFromFileTTF(file.string().c_str(), height_px, &config);
  else
    atlas.AddFontDefault();
}

}  // namespace palpate
