// Reads the text lines of a mesh as words.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/vec.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

/// Iterates over the lines that are not blank, without comments that begin with '#'; a sign within a number, as old
/// Windows programs write NaN (1.#IND), begins none.
class MeshLines {
 public:
  /// `kept`: first word of comments that are read as lines; empty: none.
  explicit MeshLines(const std::filesystem::path& file, std::string_view kept = {}) : file_(file), kept_(kept) {}

  /// False at the end of the file. A line that ends with a backslash continues on the next one, except comments.
  bool next() {
    do {
      auto line = file_.readLine(kLongestLine);
      if (!line) return false;
      text_.assign(*line);
      while (text_.ends_with('\\') && commentAt() == text_.npos && text_.size() < kLongestLine) {
        text_.back() = ' ';
        if (line = file_.readLine(kLongestLine); line) text_ += *line;
      }
      split();
    } while (words_.empty());
    return true;
  }
  /// Valid until the next call of next().
  const std::vector<std::string_view>& words() const { return words_; }
  /// The line from word `k` on; empty if there is none.
  std::string behind(std::size_t k) const {
    if (k >= words_.size()) return {};
    return {words_[k].data(), words_.back().data() + words_.back().size()};
  }
  double number(std::size_t k, std::string_view what) const {
    if (k >= words_.size()) fail(fmt::format("the line ends where {} should be", what));
    const auto value = textNumber<double>(words_[k]);
    if (!value) fail(fmt::format("found {}, expected {}", inQuotes(words_[k]), what));
    return *value;
  }
  DVec3 three(std::size_t k, std::string_view what) const {
    return {number(k, what), number(k + 1, what), number(k + 2, what)};
  }
  std::uint64_t line() const { return file_.line(); }
  bool endsInLine() const { return file_.endsInLine(); }
  [[noreturn]] void fail(std::string_view what) const { throw file_.errorInLine(what); }

 private:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  std::size_t commentAt() const {
    if (!kept_.empty() && text_.starts_with(kept_)) return text_.npos;
    std::size_t at = text_.find('#');
    while (at != text_.npos && at > 0 && text_[at - 1] == '.') at = text_.find('#', at + 1);
    return at;
  }

  void split() {
    constexpr std::string_view kBetween = " \t\r\v\f";
    const std::string_view text = std::string_view(text_).substr(0, commentAt());
    words_.clear();
    for (std::size_t begin = text.find_first_not_of(kBetween); begin != text.npos;
         begin = text.find_first_not_of(kBetween, begin)) {
      const std::size_t end = std::min(text.find_first_of(kBetween, begin), text.size());
      words_.push_back(text.substr(begin, end - begin));
      begin = end;
    }
  }

  ChunkedFile file_;
  std::string_view kept_;
  std::string text_;
  std::vector<std::string_view> words_;
};

}  // namespace palpate
