#include <windows.h>

#include "engine/core/console.hpp"

namespace palpate {

// A console understands control sequences once that mode is enabled; one that does not support it is treated as a file.
bool isErrorConsole() noexcept {
  const HANDLE console = ::GetStdHandle(STD_ERROR_HANDLE);
  DWORD mode = 0;
  return ::GetConsoleMode(console, &mode) && ::SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

}  // namespace palpate
