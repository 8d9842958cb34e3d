#include <cstdlib>

#include "apps/cli/system_places.hpp"

namespace palpate {

std::filesystem::path fontFile() { return "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"; }  // where Debian has it

std::filesystem::path stateFolder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state) return state;
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".local" / "state";
  return {};
}

}  // namespace palpate
