#include <cstdlib>

#include "apps/cli/system_places.hpp"

namespace palpate {

// Paths of Debian.
std::vector<std::filesystem::path> fontFiles() {
  const std::filesystem::path fonts = "/usr/share/fonts";
  std::vector<std::filesystem::path> files;
  for (const char* name :
       {"truetype/dejavu/DejaVuSans.ttf", "opentype/noto/NotoSansCJK-Regular.ttc", "truetype/wqy/wqy-microhei.ttc",
        "truetype/wqy/wqy-zenhei.ttc", "truetype/droid/DroidSansFallbackFull.ttf", "truetype/arphic/uming.ttc",
        "truetype/nanum/NanumGothic.ttf", "opentype/ipafont-gothic/ipag.ttf", "truetype/freefont/FreeSans.ttf",
        "truetype/noto/NotoSansThai-Regular.ttf", "truetype/noto/NotoSansDevanagari-Regular.ttf",
        "opentype/unifont/unifont.otf", "truetype/unifont/unifont.ttf"})
    files.push_back(fonts / name);
  return files;
}

std::filesystem::path programFile() { return std::filesystem::read_symlink("/proc/self/exe"); }

std::filesystem::path stateFolder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state) return state;
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".local" / "state";
  return {};
}

}  // namespace palpate
