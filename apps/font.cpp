#include "apps/font.hpp"

#include <imgui.h>

#include <filesystem>

namespace palpate {

namespace {
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // where Debian has it
}

void addFont(ImFontAtlas& atlas, float height_px) {
  std::error_code ignored;
  if (std::filesystem::exists(kFont, ignored))
    atlas.AddFontFromFileTTF(kFont, height_px);
  else
    atlas.AddFontDefault();
}

}  // namespace palpate
