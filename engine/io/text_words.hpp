// Splits a line of numbers, in the usual notations of programs, into words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Separators are blanks, tabs, commas or semicolons; between two commas or semicolons without text there is an empty
/// word. Commas inside numbers that are quoted or separated otherwise are decimal ("0,5 1,25 3", and with thousands
/// "1.234,5"), or stand between thousands ("412,050 5,231,100 88"): words then have a decimal point and nothing else.
/// The first line of numbers with a comma decides whether commas separate. Quotes around a word are removed, and a
/// doubled quote inside stands for one. Names separated by commas, semicolons or tabs may contain blanks ("Easting
/// [m]").
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
  bool hasDecimalCommas() const { return notation_ == Notation::decimalComma || hasAmbiguousCommas(); }
  /// Whether all numbers with decimal commas so far could as well be thousands.
  bool hasAmbiguousCommas() const { return notation_ == Notation::ambiguous; }
  /// A number of this line whose commas or points mean something else than in the lines before; else empty.
  const std::string& contradiction() const { return contradiction_; }
  /// Splits the line again at commas, semicolons or tabs only, so that words may contain blanks. False without such a
  /// separator.
  bool cutAtMarks();

 private:
  enum class Commas { unknown, separate, inNumbers };
  /// Of numbers with commas; ambiguous ones are read as decimal.
  enum class Notation { unknown, ambiguous, decimalComma, thousandsComma };

  void cut(bool commasSeparate, bool onlyAtMarks = false);
  bool commasAreInNumbers() const;
  void readPlain();
  void findNotation();
  std::string_view plain(std::string_view word);
  std::string_view unquoted(std::string_view word);

  std::string text_;
  std::string plain_;  // words that differ from the text
  std::vector<std::string_view> words_;
  std::string contradiction_;
  Commas commas_ = Commas::unknown;
  Notation notation_ = Notation::unknown;
  bool endsOpen_ = false;
  bool hasQuotes_ = false;          // this line
  bool hasThousandsPoint_ = false;  // "1.234,5" was among the numbers
};

}  // namespace palpate
