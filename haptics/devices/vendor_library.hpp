// A haptic vendor's driver library, found and loaded at run time, so that nothing of the vendor's is needed to build.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Where a library is looked for.
struct LibrarySearch {
  std::string_view product;   ///< in words: whose library it is
  std::string_view variable;  ///< of the environment; where it is set, the file that it names and no other
  std::span<const std::string_view> names;  ///< tried in order, as the loader finds them; "" is the program itself
  std::string_view probe;                   ///< a function that only this library has
  std::string_view advice;                  ///< what to install
};

/// Once loaded, a library stays until the program ends: drivers of haptic devices do not survive being loaded twice.
class VendorLibrary {
 public:
  struct Attempt {
    std::string name, error;  ///< the loader's own words
    bool isAbsent = false;    ///< there is no such file
  };

  /// Tries to load it; throws nothing but for want of memory.
  explicit VendorLibrary(const LibrarySearch& search);

  bool isLoaded() const { return handle_ != nullptr; }
  /// The file that was loaded, as the loader names it; empty while there is none.
  const std::string& file() const { return file_; }
  /// What failed before it was found, or all of it.
  const std::vector<Attempt>& attempts() const { return attempts_; }
  /// Why there is none, in a sentence, and what to do about it.
  std::string whyNot() const;

  /// A function; nullptr where the library has none of that name.
  void* symbol(const char* name) const;

 private:
  LibrarySearch search_;
  void* handle_ = nullptr;
  std::string file_;
  std::vector<Attempt> attempts_;
};

/// Fills a table of functions, and notes which of them the library has not.
class SymbolTable {
 public:
  explicit SymbolTable(const VendorLibrary& library) : library_(library) {}

  template <typename Function>
  void need(Function*& function, const char* name) {
    function = reinterpret_cast<Function*>(library_.symbol(name));
    if (!function) missing_.emplace_back(name);
  }
  template <typename Function>
  void offer(Function*& function, const char* name) {
    function = reinterpret_cast<Function*>(library_.symbol(name));
  }
  const std::vector<std::string>& missing() const { return missing_; }
  /// Throws Error with the names when any that is needed is missing: the library is too old, or another one.
  void requireAll(std::string_view product) const;

 private:
  const VendorLibrary& library_;
  std::vector<std::string> missing_;
};

}  // namespace palpate
