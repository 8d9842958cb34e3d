#include "haptics/devices/shared_library.hpp"

#include <windows.h>

#include <filesystem>
#include <system_error>

namespace palpate {

LoadedLibrary loadLibrary(const std::string& name) {
  const HMODULE module =
      name.empty() ? ::GetModuleHandleW(nullptr) : ::LoadLibraryW(std::filesystem::path(name).c_str());
  if (module) return {.handle = module};
  // A library with missing dependencies gives the same number, but its own file is found.
  const DWORD number = ::GetLastError();
  const bool isFound = ::SearchPathW(nullptr, std::filesystem::path(name).c_str(), L".dll", 0, nullptr, nullptr) != 0;
  const bool isAbsent = number == ERROR_MOD_NOT_FOUND && !isFound;
  return {.error = name + ": " + std::system_category().message(static_cast<int>(number)), .isAbsent = isAbsent};
}

void* functionIn(void* library, const std::string& name) {
  return reinterpret_cast<void*>(::GetProcAddress(static_cast<HMODULE>(library), name.c_str()));
}

std::string fileOf(void* function) {
  HMODULE module = nullptr;
  constexpr DWORD kHow = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
  wchar_t file[MAX_PATH]{};
  const bool known = function && ::GetModuleHandleExW(kHow, static_cast<LPCWSTR>(function), &module) &&
                     ::GetModuleFileNameW(module, file, MAX_PATH) > 0;
  return known ? std::filesystem::path(file).string() : "";
}

}  // namespace palpate
