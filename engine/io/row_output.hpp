// Writes rows of numbers to a file.
#pragma once

#include <fmt/format.h>
#include <cstddef>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

inline constexpr std::size_t kBetweenReports = 1 << 16;  ///< number of points written between progress reports

/// Collects bytes and writes them to the file in large pieces: numbers in binary, little-endian, or as the shortest
/// decimals that read back as the same number, separated by a blank or another character.
class RowOutput {
 public:
  RowOutput(const std::filesystem::path& path, bool ascii, char between = ' ')
      : file_(path), ascii_(ascii), between_(between) {}

  template <class T>
  void value(T number) {
    if (ascii_) {
      if (!atLineStart_) text_.push_back(between_);
      atLineStart_ = false;
      fmt::format_to(std::back_inserter(text_), "{}", number);
      return;
    }
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(number);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.data() + bytes.size());
  }
  /// Text as a value of its row.
  void word(std::string_view text) {
    if (!atLineStart_) text_.push_back(between_);
    atLineStart_ = false;
    text_.append(text);
  }
  /// A value given as double, stored as `type`.
  void real(ScalarType type, double number) {
    if (type == ScalarType::f64)
      value(number);
    else
      value(static_cast<float>(number));
  }
  void endRow() {
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    if (ascii_) text_.push_back('\n');
    atLineStart_ = true;
    if (text_.size() >= kPiece) flush();
  }
  void bytes(std::string_view text) { text_.append(text); }
  void headerLine(std::string_view line) {
    text_.append(line);
    text_.push_back('\n');
  }
  void finish(std::filesystem::path* keptAs) {
    flush();
    if (keptAs)
      *keptAs = file_.commitAndKeep();
    else
      file_.commit();
  }

 private:
  void flush() {
    file_.write(std::string_view(text_.data(), text_.size()));
    text_.clear();
  }

  AtomicFile file_;
  fmt::memory_buffer text_;
  bool ascii_;
  char between_;
  bool atLineStart_ = true;
};

}  // namespace palpate
