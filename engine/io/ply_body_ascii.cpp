#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/ply_body.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {
namespace {

constexpr std::size_t kLongestRow = std::size_t{64} << 20;  // a strip of a whole mesh is one line

/// Iterates over the rows of an element, one line each as the format requires; blank lines are skipped.
class AsciiRows {
 public:
  AsciiRows(ChunkedFile& file, const PlyElement& element) : file_(file), element_(element) {}

  [[noreturn]] void fail(std::string_view what) const { throw file_.errorInLine(what); }

  void nextRow(std::uint64_t row) {
    row_ = row;
    for (;;) {
      const auto line = file_.readLine(kLongestRow);
      if (!line)
        fail(fmt::format("the file ends after {} of {} rows of element '{}'; it is truncated", row, element_.count,
                         element_.name));
      rest_ = *line;
      if (skipBlanks()) return;
    }
  }

  /// The next word of the row; throws if there is none.
  std::string_view word(const PlyProperty& property) {
    if (!skipBlanks())
      fail(fmt::format("{} {} ends before '{}'; expected a value for each property", element_.name, row_ + 1,
                       property.name));
    std::size_t length = 1;
    while (length < rest_.size() && !isBlank(rest_[length])) ++length;
    const std::string_view found = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return found;
  }

  template <class T>
  T number(const PlyProperty& property) {
    const std::string_view text = word(property);
    if (const auto value = textNumber<T>(text)) return *value;
    fail(fmt::format("found {} for '{}' of {} {}, expected a number of type {}", inQuotes(text), property.name,
                     element_.name, row_ + 1, plyName(property.type)));
  }

  std::uint64_t listLength(const PlyProperty& property) {
    const auto length = number<std::int64_t>(property);
    // Each item takes at least a blank and a digit of this line.
    if (length < 0 || static_cast<std::uint64_t>(length) > (rest_.size() + 1) / 2)
      fail(fmt::format("{} {}: list '{}' claims {} items, the row does not hold them", element_.name, row_ + 1,
                       property.name, length));
    return static_cast<std::uint64_t>(length);
  }

  void skipList(const PlyProperty& property) {
    for (std::uint64_t left = listLength(property); left > 0; --left) word(property);
  }

  bool skipBlanks() {
    std::size_t blanks = 0;
    while (blanks < rest_.size() && isBlank(rest_[blanks])) ++blanks;
    rest_.remove_prefix(blanks);
    return !rest_.empty();
  }

  std::string_view rest() const { return rest_; }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  ChunkedFile& file_;
  const PlyElement& element_;
  std::uint64_t row_ = 0;
  std::string_view rest_;
};

void checkAsciiPromise(const ChunkedFile& file, const PlyElement& element) {
  // A digit and a separator per value; where the last row is too short, its line is named.
  const std::uint64_t rowBytes = 2 * element.properties.size();
  checkPromise(file, element, rowBytes, rowBytes);
}

}  // namespace

void readAsciiVertices(ChunkedFile& file, const PlyElement& element, PlyRowSink& vertices) {
  checkAsciiPromise(file, element);
  if (file.remaining()) vertices.reserve(element.count);
  AsciiRows walk(file, element);
  std::vector<std::byte> packed;
  std::vector<std::uint64_t> lines;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    walk.nextRow(row);
    lines.push_back(file.line());
    std::size_t at = packed.size();
    packed.resize(at + vertices.rowBytes());
    for (const PlyProperty& property : element.properties) {
      if (property.isList) {
        walk.skipList(property);
        continue;
      }
      visitScalar(property.type, [&]<class T>(std::type_identity<T>) {
        const T value = walk.number<T>(property);
        std::memcpy(packed.data() + at, &value, sizeof(T));
        at += sizeof(T);
      });
    }
    if (walk.skipBlanks()) {
      walk.fail(fmt::format("vertex {} has more values than its {} properties; found {}", row + 1,
                            element.properties.size(), inQuotes(walk.rest())));
    }
    if (lines.size() < kPointBatch && row + 1 < element.count) continue;
    if (const auto bad = vertices.append(packed.data(), lines.size(), false))
      throw FileError::atLine(file.path(), lines[bad->row], bad->what);
    packed.clear();
    lines.clear();
  }
}

/// Checks only the shape of the rows: some programs write other values here than their header declares, and unused data
/// should not cause errors.
void passAsciiElement(ChunkedFile& file, const PlyElement& element, PlyFaces* faces) {
  checkAsciiPromise(file, element);
  if (element.properties.empty()) return;
  const PlyProperty* indices = faces ? PlyFaces::indexList(element) : nullptr;
  const PlyProperty* uv = indices && faces->collectsCoordinates() ? PlyFaces::coordinateList(element) : nullptr;
  AsciiRows walk(file, element);
  std::vector<std::int64_t> items;
  std::vector<double> coordinates;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    walk.nextRow(row);
    std::uint32_t texture = 0;
    for (const PlyProperty& property : element.properties) {
      if (&property == uv) {
        coordinates.clear();
        for (std::uint64_t left = walk.listLength(property); left > 0; --left)
          coordinates.push_back(walk.number<double>(property));
      } else if (uv && property.name == kTextureNumber && !property.isList) {
        texture = walk.number<std::uint32_t>(property);
      } else if (&property == indices) {
        items.clear();
        for (std::uint64_t left = walk.listLength(property); left > 0; --left)
          items.push_back(walk.number<std::int64_t>(property));
        if (const auto wrong = faces->add(items, element.name == "tristrips")) walk.fail(*wrong);
      } else if (property.isList) {
        walk.skipList(property);
      } else {
        walk.word(property);
      }
    }
    if (uv) faces->addCoordinates(items, coordinates, texture);
  }
}

}  // namespace palpate
