#include <windows.h>

#include <cstdlib>

#include "apps/cli/system_places.hpp"

namespace palpate {

std::filesystem::path programFile() {
  wchar_t program[MAX_PATH]{};
  ::GetModuleFileNameW(nullptr, program, MAX_PATH - 1);
  return program;
}

// The first one is shipped with the program; the others belong to Windows.
std::vector<std::filesystem::path> fontFiles() {
  std::vector<std::filesystem::path> files{programFile().parent_path() / "DejaVuSans.ttf"};
  wchar_t windows[MAX_PATH]{};
  ::GetWindowsDirectoryW(windows, MAX_PATH - 1);
  for (const char* name : {"msyh.ttc", "msgothic.ttc", "malgun.ttf", "segoeui.ttf", "seguisym.ttf"})
    files.push_back(std::filesystem::path(windows) / "Fonts" / name);
  return files;
}

std::filesystem::path stateFolder() {
  const wchar_t* state = ::_wgetenv(L"LOCALAPPDATA");
  return state ? std::filesystem::path(state) : std::filesystem::path();
}

}  // namespace palpate
