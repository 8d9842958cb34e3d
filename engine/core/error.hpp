// Errors caused by the user or the machine. They are thrown where they are found, state what happened, where, and what
// to do, and are caught once, in main(). Our own bugs stop in check.hpp instead.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace palpate {

/// A request could not be carried out: exit code 1. The text reads "where: what; what to do".
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  template <class... Args>
  explicit Error(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

/// Wrong usage of the command line: exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A request for an annex that this palpate was built without.
class NotBuilt : public UsageError {
 public:
  /// `what` needs `option`, as in "NAME is a simulated scene and" and "PALPATE_SIMULATION".
  NotBuilt(std::string_view what, std::string_view option)
      : UsageError("{} needs {}, which this palpate was built without; build it again with -D{}=ON", what, option,
                   option) {}
};

/// A GPU that does not exist, lacks a required feature, or failed.
class GpuError : public Error {
 public:
  using Error::Error;
};

/// A file that cannot be read or written. `line` is 1-based.
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& file, std::string_view what)
      : FileError(file, 0, fmt::format("{}: {}", file.string(), what)) {}
  static FileError atLine(const std::filesystem::path& file, std::uint64_t line, std::string_view what) {
    return FileError(file, line, fmt::format("{}:{}: {}", file.string(), line, what));
  }
  static FileError atByte(const std::filesystem::path& file, std::uint64_t offset, std::string_view what) {
    return FileError(file, 0, fmt::format("{}: byte {}: {}", file.string(), offset, what));
  }

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t line() const { return line_; }  ///< 0 if unknown

 private:
  FileError(const std::filesystem::path& file, std::uint64_t line, const std::string& text)
      : Error("{}", text), file_(file), line_(line) {}

  std::filesystem::path file_;
  std::uint64_t line_ = 0;
};

}  // namespace palpate
