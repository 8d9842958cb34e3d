// Splits a line of numbers, in the usual notations of programs, into words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Separators are blanks, tabs, commas or semicolons; between two commas or semicolons without text there is an empty
/// word. Commas inside numbers that are separated otherwise are decimal ("0,5 1,25 3"); the first line of numbers with
/// a comma decides for all following lines, and words then have a point instead. Quotes around a word are removed.
/// Names separated by commas or semicolons may contain blanks ("Easting [m]").
class TextWords {
 public:
  /// The words are valid until the next call.
  void split(std::string_view line);
  const std::vector<std::string_view>& words() const { return words_; }
  bool empty() const { return words_.empty(); }
  void clear() { words_.clear(); }
  /// Whether a comma or semicolon follows the last word, so that an empty word may follow.
  bool endsOpen() const { return endsOpen_; }
  void addEmpty() { words_.emplace_back(); }
  bool hasDecimalCommas() const { return commas_ == Commas::decimal; }

 private:
  enum class Commas { unknown, separate, decimal };

  void cut(bool commasSeparate);
  bool isNumberLine() const;
  bool areCommasDecimal() const;

  std::string text_;
  std::vector<std::string_view> words_;
  Commas commas_ = Commas::unknown;
  bool endsOpen_ = false;
};

}  // namespace palpate
