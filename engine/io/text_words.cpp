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

/// Whether commas stand between groups of three digits: "5,231,100.25".
bool hasThousands(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  word = word.substr(0, word.find('.'));
  const std::size_t first = word.find(',');
  if (first == word.npos || first == 0 || first > 3 || word[0] == '0') return false;
  for (std::size_t at = 0; at < word.size(); ++at)
    if (at % 4 == first % 4 ? word[at] != ',' : !isDigit(word[at])) return false;
  return (word.size() - first) % 4 == 0;
}

bool hasDecimalComma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return word.find(',', comma + 1) == word.npos && word.find('.') == word.npos && comma + 1 < word.size() &&
         isDigit(word[comma + 1]) && (comma == 0 || isDigit(word[comma - 1]) || comma == 1);
}

}  // namespace

void TextWords::split(std::string_view line) {
  text_.assign(line);
  const bool hasComma = text_.find(',') != text_.npos;
  if (hasComma && commas_ == Commas::unknown) {
    cut(false);
    const auto numbers = std::ranges::count_if(words_, isNumberStart);
    if (isNumberLine() || (numbers >= 3 && text_.find(';') != text_.npos)) commas_ = meaningOfCommas();
  }
  const bool inNumbers = commas_ == Commas::decimal || commas_ == Commas::thousands;
  cut(!inNumbers);
  if (hasComma && inNumbers) plainNumbers();
  if (std::ranges::all_of(words_, &std::string_view::empty)) words_.clear();
}

bool TextWords::cutAtMarks() {
  if (text_.find_first_of(",;\t") == text_.npos) return false;
  cut(commas_ == Commas::unknown || commas_ == Commas::separate, true);
  return true;
}

void TextWords::cut(bool commasSeparate, bool onlyAtMarks) {
  words_.clear();
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
    const std::size_t quoted = text[at] == '"' ? text.find('"', at + 1) : text.npos;
    if (quoted != text.npos) {
      // Inside quotes a comma is not a separator.
      const auto begin = text_.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                 end = text_.begin() + static_cast<std::ptrdiff_t>(quoted);
      std::size_t length = quoted - at - 1;
      const std::string_view word = text.substr(at + 1, length);
      if (hasThousands(word) && std::ranges::count_if(word, [](char c) { return c == ',' || c == '.'; }) > 1)
        length = static_cast<std::size_t>(std::remove(begin, end, ',') - begin);
      else if (word.find_first_not_of("0123456789+-,eE") == word.npos)
        std::replace(begin, end, ',', '.');
      words_.push_back(text.substr(at + 1, length));
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

bool TextWords::isNumberLine() const { return !words_.empty() && isNumberStart(words_.front()); }

/// Requires words that were split at everything except commas.
TextWords::Commas TextWords::meaningOfCommas() const {
  if (words_.size() < 3) return Commas::separate;
  const auto all = [&](auto&& is) {
    return std::ranges::all_of(
        words_, [&](std::string_view word) { return !isNumberStart(word) || word.find(',') == word.npos || is(word); });
  };
  if (all(hasDecimalComma)) return Commas::decimal;
  return all(hasThousands) ? Commas::thousands : Commas::separate;
}

/// Writes the numbers of the line with decimal points, and without commas between thousands.
void TextWords::plainNumbers() {
  for (std::string_view& word : words_) {
    if (!isNumberStart(word) || word.find(',') == word.npos) continue;
    if (commas_ == Commas::decimal && !hasThousands(word)) areDecimal_ = true;
    const auto begin = text_.begin() + (word.data() - text_.data());
    const auto end = begin + static_cast<std::ptrdiff_t>(word.size());
    if (commas_ == Commas::decimal) std::replace(begin, end, ',', '.');
    if (commas_ == Commas::thousands && hasThousands(word))
      word = word.substr(0, static_cast<std::size_t>(std::remove(begin, end, ',') - begin));
  }
}

}  // namespace palpate
