// A library that is loaded while the program runs, and stays until it ends.
#pragma once

#include <string>

namespace palpate {

struct LoadedLibrary {
  void* handle = nullptr;
  std::string error;      ///< in the loader's own words, where there is no handle
  bool isAbsent = false;  ///< there is no such file, rather than one of no use
};

/// As the loader finds it; the empty name is the program itself.
LoadedLibrary loadLibrary(const std::string& name);

/// A function; nullptr where the library has none of that name.
void* functionIn(void* library, const std::string& name);

/// Of the library that a function is in; empty where nobody knows.
std::string fileOf(void* function);

}  // namespace palpate
