// A line of numbers as programs write them, split into words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Between words stand blanks, tabs, commas or semicolons; nothing between two commas or semicolons is an empty word.
/// Commas within numbers between which there is something else are decimal ones ("0,5 1,25 3"); the first line of
/// numbers with a comma tells for all that follow, and words have a point in their place. Quotes around a word go.
/// Names with commas or semicolons between them may have blanks within ("Easting [m]").
class TextWords {
 public:
  /// The words are valid until the next call.
  void split(std::string_view line);
  const std::vector<std::string_view>& words() const { return words_; }
  bool empty() const { return words_.empty(); }
  void clear() { words_.clear(); }
  /// A comma or semicolon stood behind the last word, where another one may be missing.
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
