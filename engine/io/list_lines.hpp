// Lists of pictures and poses, one a line.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"

namespace palpate {

/// The lines of a file that are not blank or comments.
class ListLines {
 public:
  explicit ListLines(const std::filesystem::path& path) : file_(path) {}

  bool next() {
    constexpr std::size_t kMaxLine = std::size_t{1} << 16;
    do {
      const auto line = file_.readLine(kMaxLine);
      if (!line) return false;
      rest_ = *line;
      const std::size_t begin = rest_.find_first_not_of(" \t\r");
      rest_.remove_prefix(std::min(begin, rest_.size()));
    } while (rest_.empty() || rest_.front() == '#');
    return true;
  }
  std::string_view& rest() { return rest_; }
  std::uint64_t line() const { return file_.line(); }
  [[noreturn]] void fail(std::string_view what) const { throw FileError::atLine(file_.path(), line(), what); }

 private:
  ChunkedFile file_;
  std::string_view rest_;
};

}  // namespace palpate
