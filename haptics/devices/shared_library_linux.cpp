#include "haptics/devices/shared_library.hpp"

#include <dlfcn.h>

namespace palpate {

LoadedLibrary loadLibrary(const std::string& name) {
  if (void* handle = ::dlopen(name.empty() ? nullptr : name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE))
    return {.handle = handle};
  const char* error = ::dlerror();
  LoadedLibrary none{.error = error ? error : "the loader does not say why"};
  // For a missing file the loader says "NAME: cannot open shared object file: …", about NAME itself.
  none.isAbsent = none.error.starts_with(name + ": cannot open shared object file: No such file");
  return none;
}

void* functionIn(void* library, const std::string& name) { return ::dlsym(library, name.c_str()); }

std::string fileOf(void* function) {
  Dl_info info{};
  return function && ::dladdr(function, &info) && info.dli_fname ? info.dli_fname : "";
}

}  // namespace palpate
