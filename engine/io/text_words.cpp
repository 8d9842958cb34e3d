#include "engine/io/text_words.hpp"

#include <algorithm>

namespace palpate {

namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Also true if the line begins with an empty word or a quote.
bool isNumberStart(std::string_view text) {
  if (text.starts_with('"')) text.remove_prefix(1);
  if (text.empty()) return false;
  const char c = text.front();
  return isDigit(c) || c == '-' || c == '+' || c == '.' || c == ',' || c == ';';
}

/// Whether `mark` stands between groups of three digits, and nothing else in the word: "5,231,100".
bool hasThousands(std::string_view word, char mark) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  const std::size_t first = word.find(mark);
  if (first == word.npos || first == 0 || first > 3 || word[0] == '0') return false;
  for (std::size_t at = 0; at < word.size(); ++at)
    if (at % 4 == first % 4 ? word[at] != mark : !isDigit(word[at])) return false;
  return (word.size() - first) % 4 == 0;
}

bool hasDecimalComma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return word.find(',', comma + 1) == word.npos && word.find('.') == word.npos && comma + 1 < word.size() &&
         isDigit(word[comma + 1]) && (comma == 0 || isDigit(word[comma - 1]) || comma == 1) &&
         word.find_first_not_of("0123456789+-,eEdD") == word.npos;
}

/// Position of the quote that ends the word; a doubled one is part of it.
std::size_t closingQuote(std::string_view text, std::size_t at) {
  while ((at = text.find('"', at)) != text.npos && at + 1 < text.size() && text[at + 1] == '"') at += 2;
  return at;
}

/// What commas and points of a number mean.
enum class Form { other, plain, decimalComma, thousandsComma, eitherComma, thousandsPoint, eitherPoint };

Form formOf(std::string_view word) {
  if (!isNumberStart(word)) return Form::other;
  const std::size_t comma = word.find(','), point = word.find('.');
  if (comma == word.npos) {
    if (!hasThousands(word, '.')) return Form::plain;
    return point == word.rfind('.') ? Form::eitherPoint : Form::thousandsPoint;
  }
  if (point == word.npos) {
    if (hasThousands(word, ',')) return comma == word.rfind(',') ? Form::eitherComma : Form::thousandsComma;
    return hasDecimalComma(word) ? Form::decimalComma : Form::other;
  }
  if (comma < point) {
    const bool isDecimal = word.find_first_not_of("0123456789eEdD+-", point + 1) == word.npos;
    return isDecimal && hasThousands(word.substr(0, point), ',') ? Form::thousandsComma : Form::other;
  }
  return hasThousands(word.substr(0, comma), '.') && hasDecimalComma(word.substr(comma)) ? Form::thousandsPoint
                                                                                         : Form::other;
}

}  // namespace

void TextWords::split(std::string_view line) {
  text_.assign(line);
  contradiction_.clear();
  if (commas_ == Commas::unknown && text_.find(',') != text_.npos) {
    cut(false);
    const auto numbers = std::ranges::count_if(words_, isNumberStart);
    if ((!words_.empty() && isNumberStart(words_.front())) || (numbers >= 3 && text_.find(';') != text_.npos))
      commas_ = commasAreInNumbers() ? Commas::inNumbers : Commas::separate;
  }
  cut(commas_ != Commas::inNumbers);
  readPlain();
  if (std::ranges::all_of(words_, &std::string_view::empty)) words_.clear();
}

bool TextWords::cutAtMarks() {
  if (text_.find_first_of(",;\t") == text_.npos) return false;
  cut(commas_ != Commas::inNumbers, true);
  readPlain();
  return true;
}

void TextWords::cut(bool commasSeparate, bool onlyAtMarks) {
  words_.clear();
  hasQuotes_ = false;
  const std::string_view text = text_;
  const auto isComma = [&](char c) { return c == ';' || (commasSeparate && c == ','); };
  const bool anyComma = std::ranges::any_of(text, isComma), anyMark = anyComma || text.find('\t') != text.npos;
  bool open = true, passedMark = false;
  const bool named =
      anyMark && (onlyAtMarks || !isNumberStart(text.substr(std::min(text.find_first_not_of(kBlank), text.size()))));
  const auto ends = [&](char c) {
    return isComma(c) || (named ? !anyComma && c == '\t' : kBlank.find(c) != kBlank.npos);
  };
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlank, at)) != text.npos;) {
    if (isComma(text[at])) {
      if (open) words_.emplace_back();
      open = passedMark = true;
      ++at;
      continue;
    }
    open = false;
    const std::size_t quoted = text[at] == '"' ? closingQuote(text, at + 1) : text.npos;
    if (quoted != text.npos) {
      // Inside quotes a comma is not a separator.
      words_.push_back(text.substr(at + 1, quoted - at - 1));
      hasQuotes_ = true;
      at = quoted + 1;
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && !ends(text[end])) ++end;
    const std::string_view word = text.substr(at, end - at);
    words_.push_back(word.substr(0, word.find_last_not_of(kBlank) + 1));
    at = end;
  }
  endsOpen_ = open && passedMark;
}

/// Requires words that were split at everything except commas.
bool TextWords::commasAreInNumbers() const {
  return words_.size() >= 3 && std::ranges::none_of(words_, [](std::string_view word) {
           return isNumberStart(word) && word.find(',') != word.npos && formOf(word) == Form::other;
         });
}

/// Makes of the numbers of the line such with a decimal point and nothing else, and of doubled quotes single ones.
void TextWords::readPlain() {
  const bool mayHaveCommas = commas_ == Commas::inNumbers || hasQuotes_;
  if (!mayHaveCommas && notation_ == Notation::unknown) return;
  plain_.clear();
  plain_.reserve(text_.size());  // so that words of it stay valid
  findNotation();
  for (std::string_view& word : words_) word = plain(word);
}

void TextWords::findNotation() {
  std::string_view decimal, thousands, either, point;
  for (const std::string_view word : words_) {
    const Form form = formOf(word);
    if (form == Form::decimalComma || form == Form::thousandsPoint) decimal = word;
    if (form == Form::thousandsComma) thousands = word;
    if (form == Form::eitherComma) either = word;
    if (form == Form::eitherPoint) point = word;
    if (form == Form::thousandsPoint) hasThousandsPoint_ = true;
  }
  const bool wereDecimal = hasDecimalCommas(), wereThousands = notation_ == Notation::thousandsComma;
  if (!thousands.empty() && (wereDecimal || !decimal.empty())) contradiction_ = thousands;
  if (!decimal.empty() && wereThousands) contradiction_ = decimal;
  if (!contradiction_.empty() && notation_ != Notation::unknown) return;
  if (!thousands.empty()) notation_ = Notation::thousandsComma;
  if (!decimal.empty()) notation_ = Notation::decimalComma;
  if (!either.empty() && notation_ == Notation::unknown) notation_ = Notation::ambiguous;
  if (!point.empty() && notation_ == Notation::decimalComma && !hasThousandsPoint_) contradiction_ = point;
}

std::string_view TextWords::plain(std::string_view word) {
  if (hasQuotes_ && word.find("\"\"") != word.npos) return unquoted(word);
  const bool commaIsDecimal = notation_ != Notation::thousandsComma;
  const char between = commaIsDecimal ? '.' : ',';
  const Form form = formOf(word);
  if (form == Form::other || form == Form::plain || (form == Form::eitherPoint && !hasThousandsPoint_)) return word;
  const std::size_t begin = plain_.size();
  for (const char c : word)
    if (c != between) plain_ += c == ',' ? '.' : c;
  return std::string_view(plain_).substr(begin);
}

std::string_view TextWords::unquoted(std::string_view word) {
  const std::size_t begin = plain_.size();
  for (std::size_t at = 0; at < word.size(); ++at) {
    plain_ += word[at];
    if (word[at] == '"') ++at;
  }
  return std::string_view(plain_).substr(begin);
}

}  // namespace palpate
