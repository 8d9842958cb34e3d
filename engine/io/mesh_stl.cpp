#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "engine/core/counted.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/mesh_lines.hpp"

namespace palpate {

namespace {

constexpr std::size_t kHead = 84, kTriangle = 50;  // bytes; the last four of the header are the number of triangles

void addCorners(const std::filesystem::path& file, TriangleSoup& soup, const std::array<DVec3, 3>& corners) {
  const std::size_t first = soup.corners.size();
  if (first + 3 > 0xffffffffu) throw FileError(file, "more than 4,294,967,295 corners");
  soup.corners.insert(soup.corners.end(), corners.begin(), corners.end());
  const auto at = static_cast<std::uint32_t>(first);
  soup.triangles.push_back({at, at + 1, at + 2});
}

template <class T>
T littleEndian(const std::byte* at) {
  std::uint32_t bits = 0;
  for (unsigned k = 0; k < 4; ++k) bits |= std::to_integer<std::uint32_t>(at[k]) << (8 * k);
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

ImportedMesh importBinary(ChunkedFile& file) {
  ImportedMesh mesh;
  const auto head = file.peek(kHead);
  if (head.size() < kHead) throw FileError::atByte(file.path(), head.size(), "the file ends within its header");
  const auto count = littleEndian<std::uint32_t>(head.data() + kHead - 4);
  file.consume(kHead);
  std::size_t marked = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto row = file.peek(kTriangle);
    if (row.size() < kTriangle)
      throw FileError::atByte(file.path(), file.offset() + row.size(),
                              fmt::format("the file ends after {} of {} triangles", t, count));
    std::array<DVec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        corners[k][static_cast<int>(axis)] =
            static_cast<double>(littleEndian<float>(row.data() + 12 + 12 * k + 4 * axis));
    marked += row[48] != std::byte{0} || row[49] != std::byte{0};
    addCorners(file.path(), mesh.soup, corners);
    file.consume(kTriangle);
  }
  std::uint64_t rest = 0;
  for (auto piece = file.peek(1); !piece.empty(); piece = file.peek(1)) {
    rest += piece.size();
    file.consume(piece.size());
  }
  if (rest > 0) mesh.lost.push_back(fmt::format("{} bytes after the last of {}", rest, counted(count, "triangle")));
  if (marked > 0) mesh.lost.push_back(fmt::format("colours or marks of {}", counted(marked, "triangle")));
  return mesh;
}

class StlText {
 public:
  explicit StlText(const std::filesystem::path& file) : file_(file), lines_(file) {}

  ImportedMesh read() {
    while (lines_.next()) {
      const std::string word = lowerCase(lines_.words().front());
      if (word == "facet") {
        corners_.clear();
      } else if (word == "vertex") {
        corners_.push_back(lines_.three(1, "a coordinate"));
        if (corners_.size() > 3) lines_.fail("a facet of more than three corners");
      } else if (word == "endfacet") {
        if (corners_.size() != 3) lines_.fail(fmt::format("a facet of {}", counted(corners_.size(), "corner")));
        addCorners(file_, mesh_.soup, {corners_[0], corners_[1], corners_[2]});
        corners_.clear();
      } else if (word == "solid" || word == "endsolid" || isEnd(word)) {
        open_ = word == "solid";
      } else if (word != "outer" && word != "endloop" && word != "color") {
        lines_.fail(fmt::format("found {}, expected a keyword of STL", inQuotes(lines_.words().front())));
      }
    }
    if (open_) lines_.fail("the file ends within a solid");
    return std::move(mesh_);
  }

 private:
  /// Some programs write "end solid".
  bool isEnd(std::string_view word) const {
    return word == "end" && lines_.words().size() > 1 && lowerCase(lines_.words()[1]) == "solid";
  }
  static std::string lowerCase(std::string_view word) {
    std::string lower(word);
    for (char& c : lower)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
  }

  std::filesystem::path file_;
  MeshLines lines_;
  ImportedMesh mesh_;
  std::vector<DVec3> corners_;
  bool open_ = false;
};

/// Text begins with a word with which some binary files begin as well: these have exactly the size they declare, or
/// bytes that do not occur in text.
bool isText(ChunkedFile& file) {
  constexpr std::size_t kLookedAt = 1024;
  file.passTextMark();
  const auto all = file.peek(kLookedAt);
  const auto head = all.first(std::min(all.size(), kLookedAt));
  std::string begin(reinterpret_cast<const char*>(head.data()), std::min<std::size_t>(head.size(), kHead));
  begin.erase(0, std::min(begin.find_first_not_of(" \t\r\n"), begin.size()));
  for (char& c : begin) c = static_cast<char>(c | 0x20);
  if (!begin.starts_with("solid")) return false;
  if (head.size() < kHead) return true;
  const std::uint64_t said = kHead + std::uint64_t{kTriangle} * littleEndian<std::uint32_t>(head.data() + kHead - 4);
  if (file.remaining() == said) return false;
  return std::ranges::none_of(head, [](std::byte byte) {
    const auto c = std::to_integer<unsigned>(byte);
    return c < ' ' && !(c >= '\t' && c <= '\r');
  });
}

}  // namespace

ImportedMesh importStl(const std::filesystem::path& path) {
  ChunkedFile file(path);
  return isText(file) ? StlText(path).read() : importBinary(file);
}

}  // namespace palpate
