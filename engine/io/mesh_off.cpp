#include <array>
#include <optional>

#include "engine/core/counted.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/mesh_lines.hpp"
#include "engine/io/polygon.hpp"

namespace palpate {

namespace {

class OffReader {
 public:
  explicit OffReader(const std::filesystem::path& file) : lines_(file) {}

  ImportedMesh read() {
    header();
    for (std::uint64_t i = 0; i < vertices_; ++i) {
      needLine(fmt::format("{} of {} corners", i, vertices_));
      vertex();
    }
    for (std::uint64_t i = 0; i < faces_; ++i) {
      needLine(fmt::format("{} of {} faces", i, faces_));
      face();
    }
    if (lines_.next()) lines_.fail(fmt::format("unexpected data after the last of {}", counted(faces_, "face")));
    settleColors();
    if (others_ > 0) mesh_.lost.push_back(fmt::format("{} points and lines", others_));
    if (colors_ > 0) mesh_.lost.push_back(fmt::format("the colours of {}", counted(colors_, "face")));
    if (large_ > 0)
      mesh_.lost.push_back(fmt::format("the concave outlines of {} with more than {}", counted(large_, "polygon"),
                                       counted(kLargestConcavePolygon, "corner")));
    return std::move(mesh_);
  }

 private:
  void needLine(std::string_view after) {
    if (!lines_.next()) lines_.fail(fmt::format("the file ends after {}", after));
  }
  std::uint64_t count(std::size_t k, std::string_view what) const {
    if (k >= lines_.words().size()) lines_.fail(fmt::format("the line ends where {} should be", what));
    return countIn(lines_.words()[k], what);
  }
  std::uint64_t countIn(std::string_view word, std::string_view what) const {
    const auto value = textNumber<std::uint64_t>(word);
    if (!value || *value > 0xffffffffu) lines_.fail(fmt::format("found {}, expected {}", inQuotes(word), what));
    return *value;
  }

  /// The word OFF is followed by the counts, on the same line or on the next one; some files have no word.
  void header() {
    needLine("nothing");
    std::string_view word = lines_.words().front();
    std::size_t at = 0;
    if (!textNumber<double>(word)) {
      const std::size_t name = std::min(upperCase(word).find("OFF"), word.size());
      if (name == word.size()) lines_.fail(fmt::format("found {}, expected OFF", inQuotes(word)));
      for (const char letter : upperCase(word.substr(0, name))) {
        if (letter != 'C' && letter != 'N')
          lines_.fail(
              fmt::format("OFF with the prefix {} is not read; only C and N are", inQuotes(word.substr(0, name))));
        (letter == 'C' ? hasColors_ : hasNormals_) = true;
      }
      if (lines_.words().size() > 1 && lines_.words()[1] == "BINARY")
        lines_.fail("binary OFF is not read; export it as text");
      if (const std::string_view glued = word.substr(name + 3); !glued.empty()) {
        vertices_ = countIn(glued, "the number of corners");
        faces_ = count(1, "the number of faces");
        return;
      }
      at = 1;
      if (lines_.words().size() == 1) {
        needLine("its first word");
        at = 0;
      }
    }
    vertices_ = count(at, "the number of corners");
    faces_ = count(at + 1, "the number of faces");
  }

  static std::string upperCase(std::string_view word) {
    std::string upper(word);
    for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return upper;
  }

  void vertex() {
    TriangleSoup& soup = mesh_.soup;
    soup.corners.push_back(lines_.three(0, "a coordinate"));
    if (hasNormals_) soup.normals.emplace_back(lines_.three(3, "a normal"));
    const std::size_t at = hasNormals_ ? 6 : 3, more = lines_.words().size() - at;
    if (more < 3 && hasColors_) lines_.fail("the line ends where a colour should be");
    if (more < 3 || more > 4) return;
    cornerColors_.resize(soup.corners.size() - 1);
    cornerColors_.emplace_back(lines_.three(at, "a colour"));
    for (std::size_t k = at; k < at + 3; ++k)
      whole_ = whole_ && lines_.words()[k].find_first_of(".eE") == std::string_view::npos;
  }

  /// Integers range up to 255, other numbers up to 1 or more, determined by all of them.
  void settleColors() {
    if (cornerColors_.empty()) return;
    cornerColors_.resize(mesh_.soup.corners.size());
    const std::size_t missing = cornerColors(cornerColors_, whole_, mesh_.soup.colors);
    if (missing > 0) mesh_.lost.push_back(fmt::format("{} corners have no colour, and are white", missing));
  }

  void face() {
    const std::uint64_t corners = count(0, "the number of corners of a face");
    polygon_.clear();
    for (std::size_t k = 1; k <= corners; ++k) {
      const std::uint64_t corner = count(k, "the number of a corner");
      if (corner >= vertices_)
        lines_.fail(
            fmt::format("a face refers to corner {}, counted from 0, but there are only {}", corner, vertices_));
      polygon_.push_back(static_cast<std::uint32_t>(corner));
    }
    colors_ += lines_.words().size() > corners + 1;
    others_ += corners < 3;
    large_ += corners > kLargestConcavePolygon;
    around_.clear();
    for (const std::uint32_t corner : polygon_) around_.push_back(mesh_.soup.corners[corner]);
    local_.clear();
    addPolygon(around_, local_);
    for (const auto& [a, b, c] : local_) mesh_.soup.triangles.push_back({polygon_[a], polygon_[b], polygon_[c]});
  }

  MeshLines lines_;
  ImportedMesh mesh_;
  std::vector<std::optional<DVec3>> cornerColors_;  // up to the last corner that has a colour
  bool whole_ = true;                               // all colours are integers
  std::vector<std::uint32_t> polygon_;
  std::vector<DVec3> around_;
  std::vector<std::array<std::uint32_t, 3>> local_;
  bool hasNormals_ = false, hasColors_ = false;
  std::uint64_t vertices_ = 0, faces_ = 0;
  std::size_t others_ = 0, colors_ = 0, large_ = 0;
};

}  // namespace

ImportedMesh importOff(const std::filesystem::path& file) { return OffReader(file).read(); }

}  // namespace palpate
