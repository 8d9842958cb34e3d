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

}  // namespace

void TextWords::split(std::string_view line) {
  text_.assign(line);
  const bool hasComma = text_.find(',') != text_.npos;
  if (hasComma && commas_ == Commas::unknown) {
    cut(false);
    if (isNumberLine()) commas_ = areCommasDecimal() ? Commas::decimal : Commas::separate;
  }
  cut(commas_ != Commas::decimal);
  if (hasComma && commas_ == Commas::decimal && isNumberLine()) std::ranges::replace(text_, ',', '.');
  if (std::ranges::all_of(words_, &std::string_view::empty)) words_.clear();
}

void TextWords::cut(bool commasSeparate) {
  words_.clear();
  const std::string_view text = text_;
  const auto isMark = [&](char c) { return c == ';' || (commasSeparate && c == ','); };
  bool open = true, anyMark = false;
  const bool named = !isNumberStart(text.substr(std::min(text.find_first_not_of(kBlank), text.size()))) &&
                     std::ranges::any_of(text, isMark);
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlank, at)) != text.npos;) {
    if (isMark(text[at])) {
      if (open) words_.emplace_back();
      open = anyMark = true;
      ++at;
      continue;
    }
    open = false;
    const std::size_t quoted = text[at] == '"' ? text.find('"', at + 1) : text.npos;
    if (quoted != text.npos) {
      const std::string_view word = text.substr(at + 1, quoted - at - 1);
      // Inside quotes a comma is not a separator.
      if (word.find_first_not_of("0123456789+-,eE") == word.npos)
        std::replace(text_.begin() + static_cast<std::ptrdiff_t>(at),
                     text_.begin() + static_cast<std::ptrdiff_t>(quoted), ',', '.');
      words_.push_back(word);
      at = quoted + 1;
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && (named || kBlank.find(text[end]) == kBlank.npos) && !isMark(text[end])) ++end;
    const std::string_view word = text.substr(at, end - at);
    words_.push_back(word.substr(0, word.find_last_not_of(kBlank) + 1));
    at = end;
  }
  endsOpen_ = open && anyMark;
}

bool TextWords::isNumberLine() const { return !words_.empty() && isNumberStart(words_.front()); }

/// Requires words that were split at everything except commas.
bool TextWords::areCommasDecimal() const {
  if (words_.size() < 3) return false;
  return std::ranges::all_of(words_, [](std::string_view word) {
    const std::size_t comma = word.find(',');
    if (comma == word.npos) return true;
    return word.find(',', comma + 1) == word.npos && word.find('.') == word.npos && comma + 1 < word.size() &&
           isDigit(word[comma + 1]) && (comma == 0 || isDigit(word[comma - 1]) || comma == 1);
  });
}

}  // namespace palpate
