// A library that is loaded at run time, and stays loaded until the program ends.
#pragma once

#include <string>

namespace palpate {

struct LoadedLibrary {
  void* handle = nullptr;
  std::string error;      ///< the loader's own text, if there is no handle
  bool isAbsent = false;  ///< the file does not exist; false if it exists and cannot be loaded
};

/// `name`: as the loader finds it; empty for the program itself.
LoadedLibrary loadLibrary(const std::string& name);

/// A function; nullptr if the library has none of that name.
void* functionIn(void* library, const std::string& name);

/// File of the library that contains a function; empty if unknown.
std::string fileOf(void* function);

}  // namespace palpate
