// Text files of numbers, line by line.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>

#include "engine/core/error.hpp"

namespace palpate {

inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Returns the lines with content, with their numbers: skips empty ones and those that begin with #.
class TextLines {
 public:
  /// Throws FileError for a file that cannot be opened.
  explicit TextLines(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) throw FileError(file_, "cannot be opened; check that it exists and may be read");
  }

  /// The next line, without blanks at its ends; valid until the next call. Throws FileError for a line that is far too
  /// long.
  std::optional<std::string_view> next() {
    while (in_.getline(buffer_.data(), buffer_.size())) {
      ++number_;
      std::string_view line = buffer_.data();
      constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
      if (number_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
      line = trimmed(line);
      if (!line.empty() && line.front() != '#') return line;
    }
    if (in_.bad()) throw FileError(file_, "cannot be read; is it a file?");
    if (!in_.eof()) {
      ++number_;
      fail("the line is too long; is this the right file?");
    }
    return std::nullopt;
  }

  /// Throws FileError for a field that is not a finite number.
  double number(std::string_view field) const {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error == std::errc::result_out_of_range) fail(fmt::format("'{}' is out of range", field));
    if (error != std::errc() || end != field.data() + field.size()) fail(fmt::format("'{}' is not a number", field));
    if (!std::isfinite(value)) fail(fmt::format("'{}' is not finite", field));
    return value;
  }

  /// Throws FileError about the last line that next() returned.
  [[noreturn]] void fail(std::string_view what) const {
    throw FileError::atLine(file_, std::max<std::uint64_t>(number_, 1), what);
  }

 private:
  static constexpr std::size_t kLongestLine = 4096;  // a file without line ends must not fill the memory

  std::filesystem::path file_;
  std::ifstream in_;
  std::array<char, kLongestLine> buffer_{};
  std::uint64_t number_ = 0;
};

}  // namespace palpate
