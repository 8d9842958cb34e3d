// A haptic vendor's driver library, found and loaded at run time, so that a build needs nothing of the vendor.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// How a library is found.
struct LibrarySearch {
  std::string_view product;   ///< name of the library, for messages
  std::string_view variable;  ///< environment variable; if it is set, only the file that it names is tried
  std::span<const std::string_view> names;  ///< tried in order, as the loader finds them; "" is the program itself
  std::string_view probe;                   ///< a function that only this library has
  std::string_view advice;                  ///< what to install
};

/// Once loaded, a library stays loaded until the program ends: drivers of haptic devices do not survive a second load.
class VendorLibrary {
 public:
  struct Attempt {
    std::string name, error;  ///< the loader's own text
    bool isAbsent = false;    ///< the file does not exist
  };

  /// Tries to load it; throws only if memory is exhausted.
  explicit VendorLibrary(const LibrarySearch& search);

  bool isLoaded() const { return handle_ != nullptr; }
  /// The loaded file, as the loader names it; empty if there is none.
  const std::string& file() const { return file_; }
  /// Failed attempts before it was found, or all attempts.
  const std::vector<Attempt>& attempts() const { return attempts_; }
  /// Why it is not loaded, as a sentence, and what to do about it.
  std::string whyNot() const;

  /// A function; nullptr if the library has none of that name.
  void* symbol(const char* name) const;

 private:
  LibrarySearch search_;
  void* handle_ = nullptr;
  std::string file_;
  std::vector<Attempt> attempts_;
};

/// Fills a table of functions, and collects those that the library lacks.
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
  /// Throws Error with the names if a needed function is missing: the library is too old, or another one.
  void requireAll(std::string_view product) const;

 private:
  const VendorLibrary& library_;
  std::vector<std::string> missing_;
};

}  // namespace palpate
