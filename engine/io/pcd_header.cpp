#include "engine/io/pcd_header.hpp"

#include <algorithm>
#include <array>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

#include <fmt/format.h>

namespace palpate {

namespace {

constexpr std::size_t kMaxPcdHeaderLine = std::size_t{1} << 16;
constexpr std::size_t kMaxNumbers = 4096;  // per point

std::vector<std::string> pcdWordsOf(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t begin = line.find_first_not_of(" \t"); begin != line.npos;
       begin = line.find_first_not_of(" \t", begin)) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

/// Parses the lines of a header.
class PcdHeaderLines {
 public:
  explicit PcdHeaderLines(ChunkedFile& file) : file_(file) {}

  PcdHeader read() {
    bool first = true;
    while (const auto line = file_.readLine(kMaxPcdHeaderLine)) {
      const std::vector<std::string> words = pcdWordsOf(*line);
      if (words.empty()) continue;
      if (words[0].starts_with('#')) {
        remark(*line);
      } else {
        if (first && words[0] != "VERSION" && words[0] != "FIELDS" && words[0] != "COLUMNS")
          throw FileError(file_.path(), "is not a PCD file");
        first = false;
        take(words);
        if (words[0] == "DATA") return finish();
      }
    }
    throw FileError::atLine(file_.path(), file_.line() + 1, "the file ends inside the header, before its line 'DATA'");
  }

 private:
  [[noreturn]] void fail(std::string_view what) const { throw FileError::atLine(file_.path(), file_.line(), what); }

  void remark(std::string_view line) {
    const std::size_t text = line.find_first_not_of("# \t");
    if (text != line.npos && !line.substr(text).starts_with(".PCD"))
      header_.comments.push_back("comment " + std::string(line.substr(text)));
  }

  std::uint64_t number(const std::vector<std::string>& words) const {
    const auto value = words.size() == 2 ? textNumber<std::uint64_t>(words[1]) : std::nullopt;
    if (!value) fail(fmt::format("expected one whole number after '{}'", words[0]));
    return *value;
  }

  void take(const std::vector<std::string>& words) {
    const std::string& key = words[0];
    if (key == "VERSION") return;
    if (key == "FIELDS" || key == "COLUMNS") return takeFields(words);
    if (key == "SIZE" || key == "TYPE" || key == "COUNT") return takeColumn(words);
    if (key == "WIDTH") return void(header_.width = number(words));
    if (key == "HEIGHT") return void(header_.height = number(words));
    if (key == "POINTS") {
      header_.points = number(words);
      return void(hasPoints_ = true);
    }
    if (key == "VIEWPOINT") {
      for (std::size_t k = 1; k < words.size(); ++k) header_.viewpoint += (k > 1 ? " " : "") + words[k];
      return;
    }
    if (key != "DATA") fail(fmt::format("{} is not a line of a PCD header", inQuotes(key)));
    constexpr std::array<std::string_view, 3> kNames{"ascii", "binary", "binary_compressed"};
    const auto name = std::ranges::find(kNames, words.size() == 2 ? words[1] : "");
    if (name == kNames.end()) fail("expected 'ascii', 'binary' or 'binary_compressed' after 'DATA'");
    header_.data = static_cast<PcdData>(name - kNames.begin());
  }

  void takeFields(const std::vector<std::string>& words) {
    if (!header_.fields.empty()) fail("a second line of fields");
    for (std::size_t k = 1; k < words.size(); ++k) {
      const bool twice = words[k] != "_" && std::find(words.begin() + 1, words.begin() + static_cast<std::ptrdiff_t>(k),
                                                      words[k]) != words.begin() + static_cast<std::ptrdiff_t>(k);
      if (twice) fail(fmt::format("a second field {}", inQuotes(words[k])));
      header_.fields.push_back({.name = words[k]});
    }
  }

  void takeColumn(const std::vector<std::string>& words) {
    if (words.size() != header_.fields.size() + 1)
      fail(fmt::format("{} has {} entries for {} fields", words[0], words.size() - 1, header_.fields.size()));
    for (std::size_t k = 0; k < header_.fields.size(); ++k) {
      PcdField& field = header_.fields[k];
      const std::string& word = words[k + 1];
      if (words[0] == "TYPE") {
        if (word != "I" && word != "U" && word != "F") fail(fmt::format("type {}; expected I, U or F", inQuotes(word)));
        field.type = word[0];
        continue;
      }
      const auto value = textNumber<std::uint32_t>(word);
      if (!value || *value > kMaxNumbers)
        fail(fmt::format("{} of {} is {}", words[0], inQuotes(field.name), inQuotes(word)));
      (words[0] == "SIZE" ? field.bytes : field.count) = *value;
    }
  }

  PcdHeader finish() {
    std::size_t numbers = 0;
    for (const PcdField& field : header_.fields) {
      numbers += field.count;
      const bool known = field.type == 'F'
                             ? field.bytes == 4 || field.bytes == 8
                             : field.bytes == 1 || field.bytes == 2 || field.bytes == 4 || field.bytes == 8;
      if (!known && field.name != "_")
        fail(fmt::format("field {} has numbers {} of {} bytes", inQuotes(field.name), field.type, field.bytes));
    }
    if (numbers > kMaxNumbers) fail(fmt::format("more than {} numbers a point", kMaxNumbers));
    if (header_.width > 0 && header_.height > ~std::uint64_t{0} / header_.width) fail("too many points");
    const std::uint64_t grid = header_.width * header_.height;
    if (!hasPoints_) header_.points = grid;
    if (header_.points != grid)
      fail(fmt::format("{} points in a grid of {} x {}", header_.points, header_.width, header_.height));
    header_.line = file_.line();
    return std::move(header_);
  }

  ChunkedFile& file_;
  PcdHeader header_;
  bool hasPoints_ = false;
};

bool isPacked(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && field.bytes == 4 && field.count == 1;
}

}  // namespace

std::size_t PcdHeader::rowBytes() const {
  std::size_t bytes = 0;
  for (const PcdField& field : fields) bytes += field.bytes * field.count;
  return bytes;
}

PcdHeader readPcdHeader(ChunkedFile& file) { return PcdHeaderLines(file).read(); }

std::vector<PcdRows::Column> PcdRows::columnsOf(const PcdHeader& header, PlyElement* element) {
  std::vector<Column> columns;
  std::size_t at = 0;
  const auto add = [&](const std::string& name, ScalarType type, std::size_t where) {
    columns.push_back({where, type});
    if (element) element->properties.push_back({.name = name, .type = type});
  };
  for (const PcdField& field : header.fields) {
    const std::size_t begin = at;
    at += field.bytes * field.count;
    if (field.name == "_") continue;
    if (isPacked(field)) {
      constexpr std::array<const char*, 4> kBytes{"blue", "green", "red", "alpha"};
      for (std::size_t k = 0; k < (field.name == "rgba" ? 4 : 3); ++k) add(kBytes[k], ScalarType::u8, begin + k);
      continue;
    }
    for (std::size_t k = 0; k < field.count; ++k) {
      const char* kind = field.type == 'I' ? "int" : field.type == 'U' ? "uint" : "float";
      add(field.count == 1 ? field.name : fmt::format("{}_{}", field.name, k),
          *scalarTypeFromPly(fmt::format("{}{}", kind, 8 * field.bytes)), begin + k * field.bytes);
    }
  }
  return columns;
}

PlyElement PcdRows::elementOf(const PcdHeader& header) {
  PlyElement element{.name = "vertex", .count = header.points, .properties = {}, .line = header.line};
  columnsOf(header, &element);
  return element;
}

PcdRows::PcdRows(const std::filesystem::path& file, const PcdHeader& header, Log* log)
    : columns_(columnsOf(header, nullptr)), rowBytes_(header.rowBytes()), vertices_(file, elementOf(header), log) {}

void PcdRows::appendRow(const std::byte* row) {
  const auto put = [&](auto value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    packed_.insert(packed_.end(), bytes, bytes + sizeof value);
  };
  for (const Column& column : columns_)
    visitScalar(column.type, [&]<class T>(std::type_identity<T>) { put(loadScalar<T>(row + column.at)); });
}

std::optional<PcdRows::Bad> PcdRows::append(const std::byte* rows, std::size_t count) {
  packed_.clear();
  for (std::size_t r = 0; r < count; ++r) appendRow(rows + r * rowBytes_);
  if (const auto bad = vertices_.append(packed_.data(), count, false)) return Bad{bad->row, bad->what};
  return std::nullopt;
}

}  // namespace palpate
