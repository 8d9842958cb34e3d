#include "apps/cli/font.hpp"

#include <imgui.h>

#include <algorithm>

#include "apps/cli/system_places.hpp"

namespace palpate {

namespace {

// Ranges as in ImGui: pairs of the first and the last letter, and a zero.
bool hasAll(const ImFont& font, std::span<const unsigned short> letters) {
  for (std::size_t k = 0; k + 1 < letters.size(); k += 2)
    for (unsigned letter = letters[k]; letter <= letters[k + 1]; ++letter)
      if (letters[k] > 0xff && !font.FindGlyphNoFallback(static_cast<ImWchar>(letter))) return false;
  return true;
}

}  // namespace

void addFont(ImFontAtlas& atlas, float height_px, Texels texels, std::span<const unsigned short> letters) {
  std::vector<std::filesystem::path> files = fontFiles();
  std::erase_if(files, [](const std::filesystem::path& file) {
    std::error_code ignored;
    return !std::filesystem::exists(file, ignored);
  });
  const ImWchar* const ranges = letters.empty() ? nullptr : letters.data();
  // Further fonts, which may be large, are read only if letters are missing in those before them.
  for (std::size_t count = 1;; ++count) {
    atlas.Clear();
    if (files.empty()) atlas.AddFontDefault();
    for (std::size_t k = 0; k < std::min(count, files.size()); ++k) {
      ImFontConfig config;
      if (texels == Texels::pixels) {
        config.OversampleH = config.OversampleV = 1;
        config.PixelSnapH = true;
      }
      config.MergeMode = k > 0;
      atlas.AddFontFromFileTTF(files[k].string().c_str(), height_px, &config, ranges);
    }
    atlas.Build();
    if (count >= files.size() || hasAll(*atlas.Fonts[0], letters)) return;
  }
}

}  // namespace palpate
