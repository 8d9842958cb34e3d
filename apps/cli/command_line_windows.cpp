#include "apps/cli/command_line.hpp"

#include <windows.h>

#include <shellapi.h>

#include <filesystem>

namespace palpate {

// The words that main() gets are in the letters of the country, and names of files may have others.
std::vector<std::string> commandLine(int argc, char** argv) {
  ::SetConsoleOutputCP(CP_UTF8);
  int count = 0;
  wchar_t** const wide = ::CommandLineToArgvW(::GetCommandLineW(), &count);
  if (!wide) return {argv, argv + argc};
  std::vector<std::string> words;
  for (int i = 0; i < count; ++i) words.push_back(std::filesystem::path(wide[i]).string());
  ::LocalFree(wide);
  return words;
}

}  // namespace palpate
