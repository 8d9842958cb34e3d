#include "haptics/devices/vendor_library.hpp"

#include <cstdlib>

#include "engine/core/error.hpp"
#include "haptics/devices/shared_library.hpp"

namespace palpate {

VendorLibrary::VendorLibrary(const LibrarySearch& search) : search_(search) {
  const std::string variable(search.variable);
  const char* named = std::getenv(variable.c_str());
  std::vector<std::string> names(search.names.begin(), search.names.end());
  if (named && *named) names = {named};
  for (const std::string& name : names) {
    const LoadedLibrary loaded = loadLibrary(name);
    if (!loaded.handle) {
      attempts_.push_back({name, loaded.error, loaded.isAbsent});
      continue;
    }
    void* probe = functionIn(loaded.handle, std::string(search.probe));
    if (!probe) {
      attempts_.push_back({name.empty() ? "the program itself" : name, fmt::format("has no {}", search.probe), false});
      continue;
    }
    handle_ = loaded.handle;
    file_ = fileOf(probe);
    return;
  }
}

std::string VendorLibrary::whyNot() const {
  if (isLoaded()) return {};
  std::string there;  // found, but unusable
  for (const Attempt& attempt : attempts_)
    if (!attempt.isAbsent && attempt.name != "the program itself")
      there += fmt::format("{}{}", there.empty() ? "" : "; ",
                           attempt.error.find(attempt.name) != std::string::npos
                               ? attempt.error
                               : fmt::format("{}: {}", attempt.name, attempt.error));
  const std::string variable(search_.variable);
  const char* named = std::getenv(variable.c_str());
  const std::string mend = named && *named ? fmt::format("{} names it; correct or unset it", variable)
                                           : fmt::format("{}, or name the library with {}", search_.advice, variable);
  if (!there.empty()) return fmt::format("{} was found but cannot be loaded: {}; {}", search_.product, there, mend);
  std::string names;
  for (const Attempt& attempt : attempts_)
    if (attempt.isAbsent) names += (names.empty() ? "" : ", ") + attempt.name;
  return fmt::format("{} is not on this machine (looked for {}); {}", search_.product, names, mend);
}

void* VendorLibrary::symbol(const char* name) const { return handle_ ? functionIn(handle_, name) : nullptr; }

void SymbolTable::requireAll(std::string_view product) const {
  if (missing_.empty()) return;
  std::string names;
  for (const std::string& name : missing_) names += (names.empty() ? "" : ", ") + name;
  throw Error("{}: {} has no {}; it is too old or another library: install the vendor's current driver", product,
              library_.file(), names);
}

}  // namespace palpate
