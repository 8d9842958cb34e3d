// Splits a line of numbers, in the usual notations of programs, into words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Separators are blanks, tabs, commas or semicolons; between two commas or semicolons without text there is an empty
/// word. Commas inside numbers that are separated otherwise are decimal ("0,5 1,25 3"), and words then have a point
/// instead, or stand between thousands ("412,050 5,231,100 88"), and words are then without them; the first line of
/// numbers with a comma decides for all following lines. Quotes around a word are removed. Names separated by commas,
/// semicolons or tabs may contain blanks ("Easting [m]").
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
  /// Whether all numbers with decimal commas so far could as well be thousands.
  bool hasAmbiguousCommas() const { return commas_ == Commas::decimal && !areDecimal_; }
  /// Splits the line again at commas, semicolons or tabs only, so that words may contain blanks. False without such a
  /// separator.
  bool cutAtMarks();

 private:
  enum class Commas { unknown, separate, decimal, thousands };

  void cut(bool commasSeparate, bool onlyAtMarks = false);
  Commas meaningOfCommas() const;
  void plainNumbers();
  bool isNumberLine() const;

  std::string text_;
  std::vector<std::string_view> words_;
  Commas commas_ = Commas::unknown;
  bool endsOpen_ = false;
  bool areDecimal_ = false;  // a comma was certainly a decimal one
};

}  // namespace palpate
