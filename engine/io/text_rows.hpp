// Iterates over the lines of a text file that contain points, and determines the meaning of columns.
#pragma once

#include <optional>
#include <string>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/text_words.hpp"

namespace palpate {

enum class TextKind { xyz, csv, pts };

/// Possible meanings of three columns without names, according to the rows so far.
struct UnnamedColumns {
  bool normals = true, shares = true, bytes = true, whole = true;
  bool anyNormal = false;

  void take(std::string_view a, std::string_view b, std::string_view c);
  bool areNormals() const { return normals && anyNormal; }
  bool areColors() const { return shares || bytes; }
};

class TextRows {
 public:
  /// Advances to the first point. `columns`: names that replace those of the file. Throws FileError.
  TextRows(const std::filesystem::path& path, TextKind kind, const std::vector<std::string>& columns);

  [[noreturn]] void fail(std::string_view what) const { throw file_.errorInLine(what); }

  ChunkedFile& file() { return file_; }
  /// Columns 4 to 6 that may be normals or colours are called kUnnamed until all rows were read.
  const std::vector<std::string>& names() const { return names_; }
  static constexpr std::array<const char*, 3> kUnnamed{"column_4", "column_5", "column_6"};
  /// Whether there are columns kUnnamed.
  bool hasUnnamed() const { return unnamed_; }
  const UnnamedColumns& unnamed() const { return looked_; }
  /// Call after the last row: throws FileError if the unnamed columns can be neither normals nor colours.
  void checkUnnamed() const;
  /// Words of the current point's row; empty after the last.
  const std::vector<std::string_view>& words() const { return words_.words(); }
  void next();

  /// The number in a column; NaN if it is marked as missing. Throws FileError with the line.
  double number(std::size_t column) const;

 private:
  void begin();
  bool isCount();
  void countPoint();
  void checkEnd() const;
  void checkColumns();
  void keepApart();
  std::vector<std::string> usualNames();
  void look();

  ChunkedFile file_;
  std::vector<std::string> names_;
  TextWords words_;
  bool counted_;  // lines contain the number of points that follow
  bool named_;    // by the caller
  bool unnamed_ = false;
  std::size_t colorsAt_ = 0;  // of columns without names; 0: none
  std::uint64_t firstLine_ = 0;
  UnnamedColumns looked_;
  std::optional<std::uint64_t> promised_;
  std::uint64_t seen_ = 0;
};

}  // namespace palpate
