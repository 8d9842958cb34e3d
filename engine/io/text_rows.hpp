// Iterates over the lines of a text file that contain points, and determines the meaning of columns.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/column_names.hpp"
#include "engine/io/text_words.hpp"

namespace palpate {

enum class TextKind { xyz, csv, pts };

class TextRows {
 public:
  /// Advances to the first point. `columns`: names that replace those of the file. Throws FileError.
  TextRows(const std::filesystem::path& path, TextKind kind, const std::vector<std::string>& columns);

  [[noreturn]] void fail(std::string_view what) const { throw file_.errorInLine(what); }

  ChunkedFile& file() { return file_; }
  /// Columns without names behind x y z are called column_4, column_5 and so on until all rows were read.
  const std::vector<std::string>& names() const { return names_; }
  bool hasUnnamed() const { return unnamed_.has_value(); }
  /// Meaning of the columns without names. Call after the last row; throws FileError if there is none, or are several.
  UnnamedColumns::Layout unnamedLayout() const;
  /// Whether colours are whole numbers in all rows so far.
  bool hasWholeColors() const { return unnamed_ ? unnamed_->hasWholeColors() : wholeColors_; }
  /// Unit of length in the names of x, y and z.
  LengthUnit unit() const { return unit_; }
  /// What is said of the columns: axes that were scaled to the unit of another.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// Words of the current point's row; empty after the last. A colour as on the web, #rrggbb, is three words.
  const std::vector<std::string_view>& words() const { return hexAt_ ? row_ : words_.words(); }
  void next();

  /// The number in a column; NaN if it is marked as missing, or a word in a column that is carried. Throws FileError
  /// with the line.
  double number(std::size_t column);
  /// Columns that have only words, which a cloud cannot keep.
  std::vector<std::string> wordColumns() const;
  /// What was passed over, in words: title lines and words.
  std::vector<std::string> lost() const;

 private:
  /// Words in a column that is carried.
  struct WordsIn {
    std::uint64_t count = 0, rounded = 0, line = 0;  // rounded: whole numbers beyond 2^53; line of the first word
    std::string first = {};
  };
  /// An axis whose unit is not that of x.
  struct Scaled {
    std::size_t column;
    double times, per;
  };
  void begin();
  bool takeNames(std::vector<std::string_view> words);
  void useUnits(const std::array<LengthUnit, 3>& units);
  bool isPoint() const;
  bool isHexRow() const;
  bool isCount();
  void countPoint();
  void checkEnd() const;
  void checkColumns();
  void keepApart();
  void findHexColor();
  void spreadHexColor();
  std::vector<std::string> usualNames();
  void look();

  ChunkedFile file_;
  std::vector<std::string> names_;
  TextWords words_;
  std::vector<std::string_view> row_;  // with the colour spread over three words
  std::array<std::string, 3> hexWords_;
  std::optional<std::size_t> hexAt_;  // column of colours as on the web
  TextKind kind_;
  bool named_;  // by the caller
  LengthUnit unit_ = LengthUnit::unknown;
  std::vector<Scaled> scaled_;
  std::vector<std::string> remarks_;
  std::optional<UnnamedColumns> unnamed_;
  std::uint64_t firstLine_ = 0, titles_ = 0;
  bool wholeColors_ = true;
  std::vector<WordsIn> wordsIn_;
  std::uint64_t points_ = 0;
  std::optional<std::uint64_t> promised_;
  std::uint64_t seen_ = 0;
};

}  // namespace palpate
