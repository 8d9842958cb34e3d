#include "engine/io/file_start.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/text_number.hpp"
#include "engine/io/text_words.hpp"

namespace palpate {

bool FileStart::isText() const {
  const std::string_view text = std::string_view(bytes).substr(0, bytes.size() - bytes.ends_with('\x1a'));
  return std::ranges::none_of(text, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < ' ' && !(byte >= '\t' && byte <= '\r');
  });
}

std::vector<std::vector<std::string>> FileStart::lines(std::size_t most) const {
  std::vector<std::vector<std::string>> lines;
  TextWords words;
  for (std::string_view rest = bytes; !rest.empty() && lines.size() < most;) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    words.split(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (words.empty() || words.words().front().starts_with('#') || words.words().front().starts_with("//")) continue;
    lines.emplace_back(words.words().begin(), words.words().end());
  }
  return lines;
}

std::optional<FileStart> startOf(const std::filesystem::path& path) {
  constexpr std::size_t kLookedAt = 4096;
  if (!isFile(path)) return std::nullopt;
  try {
    ChunkedFile file(path);
    const std::uint64_t size = file.remaining().value_or(0);
    file.passTextMark();
    const auto all = file.peek(kLookedAt);
    return FileStart{.bytes = {reinterpret_cast<const char*>(all.data()), std::min(all.size(), kLookedAt)},
                     .size = size};
  } catch (const FileError&) {  // the reader reports the error
    return std::nullopt;
  }
}

bool isNumberWord(std::string_view word) { return textNumber<double>(word).has_value(); }

}  // namespace palpate
