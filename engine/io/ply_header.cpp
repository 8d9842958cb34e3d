#include "engine/io/ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {
namespace {

constexpr std::size_t kLongestHeaderLine = std::size_t{1} << 16;
constexpr std::uint64_t kLongestHeader = std::uint64_t{1} << 20;
constexpr std::size_t kMaxNames = 1024;  // elements, and properties of one element; names are compared pairwise
constexpr std::string_view kBlank = " \t\v\f\r";

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kBlank); at != line.npos; at = line.find_first_not_of(kBlank, at)) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Parses header lines into a PlyInfo, one call per line.
class HeaderParser {
 public:
  explicit HeaderParser(const ChunkedFile& file) : file_(file) {}

  /// False after the line `end_header`.
  bool take(std::string_view line) {
    const auto words = wordsOf(line);
    if (words.empty()) return true;
    if (words[0] == "comment" || words[0] == "obj_info") {
      info_.comments.emplace_back(line);
    } else if (words[0] == "format") {
      takeFormat(words);
    } else if (words[0] == "element") {
      takeElement(words);
    } else if (words[0] == "property") {
      takeProperty(words);
    } else if (words[0] == "end_header") {
      if (!hasFormat_) fail("the header has no 'format' line; expected for example 'format ascii 1.0'");
      return false;
    } else {
      fail("{} is not a header line; expected format, comment, obj_info, element, property or end_header",
           inQuotes(line));
    }
    return true;
  }
  PlyInfo finish() { return std::move(info_); }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw FileError::atLine(file_.path(), file_.line(), fmt::format(text, std::forward<Args>(args)...));
  }

  void takeFormat(const std::vector<std::string_view>& words) {
    if (hasFormat_) fail("a second 'format' line");
    if (words.size() != 3) fail("found {} words, expected 'format ENCODING 1.0'", words.size());
    hasFormat_ = true;
    for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::binaryLittleEndian, PlyFormat::binaryBigEndian}) {
      if (words[1] != plyName(format)) continue;
      if (words[2] != "1.0") fail("PLY version {} is unknown; expected 1.0", inQuotes(words[2]));
      info_.format = format;
      return;
    }
    fail("format {} is unknown; expected ascii, binary_little_endian or binary_big_endian", inQuotes(words[1]));
  }

  void takeElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("found {} words, expected 'element NAME COUNT'", words.size());
    PlyElement element{.name = std::string(words[1]), .count = 0, .properties = {}, .line = file_.line()};
    if (info_.find(element.name)) fail("a second element {}", inQuotes(element.name));
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc{} || stop != end) {
      fail("the count of element {} is {}; expected a whole number from 0 to 2^64 - 1", inQuotes(words[1]),
           inQuotes(words[2]));
    }
    if (info_.elements.size() == kMaxNames) fail("more than {} elements", kMaxNames);
    info_.elements.push_back(std::move(element));
  }

  void takeProperty(const std::vector<std::string_view>& words) {
    if (info_.elements.empty()) fail("a property before the first element");
    const bool isList = words.size() > 1 && words[1] == "list";
    if (words.size() != (isList ? 5u : 3u)) {
      fail("found {}, expected 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'",
           words.size() == 1 ? "nothing after 'property'" : fmt::format("{} words", words.size()));
    }
    PlyProperty property{
        .name = std::string(words.back()), .type = typeNamed(words[words.size() - 2]), .isList = isList};
    if (isList) {
      property.countType = typeNamed(words[2]);
      if (isFloating(property.countType))
        fail("a list cannot have {} items; expected an integer type", inQuotes(words[2]));
    }
    auto& properties = info_.elements.back().properties;
    const auto sameName = [&](const PlyProperty& other) { return other.name == property.name; };
    if (std::any_of(properties.begin(), properties.end(), sameName)) {
      fail("a second property {} in element {}", inQuotes(property.name), inQuotes(info_.elements.back().name));
    }
    if (properties.size() == kMaxNames) fail("more than {} properties in one element", kMaxNames);
    properties.push_back(std::move(property));
  }

  ScalarType typeNamed(std::string_view name) const {
    const auto type = scalarTypeFromPly(name);
    if (!type) {
      fail("type {} is unknown; expected char, uchar, short, ushort, int, uint, float, double or int8 to float64",
           inQuotes(name));
    }
    return *type;
  }

  const ChunkedFile& file_;
  PlyInfo info_;
  bool hasFormat_ = false;
};

void checkMagic(ChunkedFile& file) {
  file.passTextMark();
  const auto start = file.peek(64);
  const std::string_view text(reinterpret_cast<const char*>(start.data()), std::min<std::size_t>(start.size(), 64));
  if (text.empty()) throw FileError::atLine(file.path(), 1, "the file is empty; expected a PLY file");
  if (text.starts_with("version https://git-lfs")) {
    throw FileError::atLine(file.path(), 1, "this is a Git LFS pointer, not the file itself; run 'git lfs pull'");
  }
  const std::string_view firstLine = text.substr(0, text.find_first_of("\r\n"));
  if (firstLine.substr(0, firstLine.find_last_not_of(kBlank) + 1) != "ply") {
    throw FileError(file.path(), "is not a PLY file");
  }
}

// Size of a binary body; nothing if lists make it depend on the rows.
std::optional<std::uint64_t> bodyBytes(const PlyInfo& info) {
  std::uint64_t bytes = 0;
  for (const PlyElement& element : info.elements) {
    const std::uint64_t rowBytes = element.scalarBytes();
    if (element.hasLists() || (rowBytes > 0 && element.count > (UINT64_MAX - bytes) / rowBytes)) return std::nullopt;
    bytes += element.count * rowBytes;
  }
  return bytes;
}

// If lines end with CR, an LF after the last one is the first byte of the body. But if the file has one byte more than
// the body, that line ended with CR LF.
void passLineFeed(ChunkedFile& file, const PlyInfo& info) {
  if (info.format == PlyFormat::ascii || !file.linesEndWithCr()) return;
  const auto next = file.peek(1);
  if (next.empty() || next[0] != std::byte{'\n'}) return;
  const auto body = bodyBytes(info), left = file.remaining();
  if (body && left && *left == *body + 1) file.consume(1);
}

}  // namespace

std::string_view plyName(PlyFormat format) {
  switch (format) {
    case PlyFormat::ascii:
      return "ascii";
    case PlyFormat::binaryLittleEndian:
      return "binary_little_endian";
    case PlyFormat::binaryBigEndian:
      break;
  }
  return "binary_big_endian";
}

bool PlyElement::hasLists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.isList; });
}

std::size_t PlyElement::scalarBytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += property.isList ? 0 : sizeOf(property.type);
  return bytes;
}

const PlyElement* PlyInfo::find(std::string_view element) const {
  const auto found =
      std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

PlyInfo readPlyInfo(const std::filesystem::path& path) {
  ChunkedFile file(path);
  return readPlyHeader(file);
}

PlyInfo readPlyHeader(ChunkedFile& file) {
  checkMagic(file);
  HeaderParser parser(file);
  file.readLine(kLongestHeaderLine);  // ply
  while (const auto line = file.readLine(kLongestHeaderLine)) {
    if (!parser.take(*line)) {
      PlyInfo info = parser.finish();
      passLineFeed(file, info);
      return info;
    }
    if (file.offset() > kLongestHeader) {
      throw FileError::atLine(file.path(), file.line(),
                              fmt::format("no 'end_header' in the first {} bytes", kLongestHeader));
    }
  }
  throw FileError::atLine(file.path(), file.line(), "the file ends inside the header; expected 'end_header'");
}

}  // namespace palpate
