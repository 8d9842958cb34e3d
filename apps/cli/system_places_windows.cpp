#include <windows.h>

#include <cstdlib>

#include "apps/cli/system_places.hpp"

namespace palpate {

// It travels beside the program.
std::filesystem::path fontFile() {
  wchar_t program[MAX_PATH]{};
  ::GetModuleFileNameW(nullptr, program, MAX_PATH - 1);
  return std::filesystem::path(program).parent_path() / "DejaVuSans.ttf";
}

std::filesystem::path stateFolder() {
  const wchar_t* state = ::_wgetenv(L"LOCALAPPDATA");
  return state ? std::filesystem::path(state) : std::filesystem::path();
}

}  // namespace palpate
