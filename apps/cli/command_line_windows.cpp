#include "apps/cli/command_line.hpp"

#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <shellapi.h>

#include <cstdio>
#include <filesystem>

namespace palpate {

// main() receives its arguments in the local code page, which cannot represent all file names.
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

void passBytes(std::FILE* stream) noexcept { ::_setmode(::_fileno(stream), _O_BINARY); }

void keepConsole(int exitCode) {
  DWORD processes[2]{}, mode = 0;
  const bool isOwn = ::GetConsoleProcessList(processes, 2) == 1;
  if (exitCode == 0 || !isOwn || !::GetConsoleMode(::GetStdHandle(STD_INPUT_HANDLE), &mode)) return;
  std::fputs("Press Enter to close this window.\n", stderr);
  std::getchar();
}

}  // namespace palpate
