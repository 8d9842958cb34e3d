#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <unordered_map>

#include "engine/core/counted.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/mesh_lines.hpp"
#include "engine/io/polygon.hpp"

namespace palpate {

namespace {

class ObjReader {
 public:
  explicit ObjReader(const std::filesystem::path& file) : lines_(file) {}

  ImportedMesh read() {
    while (lines_.next()) {
      const std::string_view word = lines_.words().front();
      if (word == "v") {
        vertex();
      } else if (word == "vn") {
        normals_.emplace_back(lines_.three(1, "a normal"));
      } else if (word == "f" || word == "fo") {
        face();
      } else if (word == "l" || word == "p") {
        ++others_;
      } else if (isOneOf(word, kFreeForms)) {
        ++freeForms_;
      } else if (!isOneOf(word, kPassedOver)) {
        if (isEmpty()) lines_.fail(fmt::format("found {}, expected a statement of OBJ", inQuotes(word)));
        ++unknown_;
      }
    }
    if (lines_.endsInLine()) mesh_.openLine = lines_.line();
    return finish();
  }

 private:
  static constexpr std::string_view kFreeForms[] = {"curv", "curv2", "surf"};
  static constexpr std::string_view kPassedOver[] = {
      "vt",    "vp",   "o",        "g",        "s",          "mg",        "usemtl", "mtllib", "usemap", "maplib",
      "bevel", "lod",  "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech",  "stech",  "cstype", "deg",
      "bmat",  "step", "parm",     "trim",     "hole",       "scrv",      "sp",     "end",    "con",    "call"};

  static bool isOneOf(std::string_view word, std::span<const std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
  }
  bool isEmpty() const { return places_.empty() && mesh_.soup.triangles.empty(); }

  void vertex() {
    const std::size_t count = lines_.words().size();
    places_.push_back(lines_.three(1, "a coordinate"));
    if (places_.size() > 0xffffffffu) lines_.fail("more than 4,294,967,295 corners");
    if (count < 7) return;  // at most a weight; 7 or more: colours, in some programs with an opacity
    colors_.resize(places_.size() - 1);
    colors_.emplace_back(lines_.three(4, "a colour"));
  }

  /// Converts a reference to an index below `count`: references count from 1, or back from the last if negative.
  std::uint32_t referred(std::string_view text, std::size_t count, std::string_view what) const {
    const auto number = textNumber<std::int64_t>(text);
    if (!number) lines_.fail(fmt::format("found {}, expected the number of {}", inQuotes(text), what));
    const std::int64_t index = *number < 0 ? *number + static_cast<std::int64_t>(count) : *number - 1;
    if (*number == 0 || index < 0 || index >= static_cast<std::int64_t>(count))
      lines_.fail(fmt::format("a face refers to {} {}, but only {} precede it", what, *number, count));
    return static_cast<std::uint32_t>(index);
  }

  void face() {
    polygon_.clear();
    normalsOf_.clear();
    for (std::size_t k = 1; k < lines_.words().size(); ++k) {
      const std::string_view word = lines_.words()[k];
      const std::size_t first = word.find('/');
      polygon_.push_back(referred(word.substr(0, first), places_.size(), "corner"));
      const std::size_t second = first == word.npos ? first : word.find('/', first + 1);
      if (second != word.npos && second + 1 < word.size())
        normalsOf_.push_back(referred(word.substr(second + 1), normals_.size(), "normal"));
    }
    if (polygon_.size() < 3) {
      ++others_;
      return;
    }
    large_ += polygon_.size() > kLargestConcavePolygon;
    facing_ = facing_ && normalsOf_.size() == polygon_.size();
    around_.clear();
    for (const std::uint32_t place : polygon_) around_.push_back(places_[place]);
    local_.clear();
    addPolygon(around_, local_);
    for (const auto& [a, b, c] : local_) {
      mesh_.soup.triangles.push_back({polygon_[a], polygon_[b], polygon_[c]});
      if (facing_) cornerNormals_.insert(cornerNormals_.end(), {normalsOf_[a], normalsOf_[b], normalsOf_[c]});
    }
  }

  ImportedMesh finish() {
    TriangleSoup& soup = mesh_.soup;
    const std::size_t uncolored = settleColors();
    if (uncolored > 0) mesh_.lost.push_back(fmt::format("{} corners have no colour, and are white", uncolored));
    if (facing_ && !cornerNormals_.empty()) {
      pairUp();
    } else {
      if (soup.triangles.empty() && normals_.size() == places_.size()) soup.normals = std::move(normals_);
      soup.corners = std::move(places_), soup.colors = std::move(bytes_);
    }
    if (others_ > 0) mesh_.lost.push_back(fmt::format("{} points and lines", others_));
    if (freeForms_ > 0) mesh_.lost.push_back(fmt::format("{} free-form curves and surfaces", freeForms_));
    if (unknown_ > 0) mesh_.lost.push_back(fmt::format("{} unknown statements", unknown_));
    if (large_ > 0)
      mesh_.lost.push_back(fmt::format("the dents of {} with more than {}", counted(large_, "polygon"),
                                       counted(kLargestConcavePolygon, "corner")));
    return std::move(mesh_);
  }

  /// Returns the number of corners without a colour if others have one.
  std::size_t settleColors() {
    if (colors_.empty()) return 0;
    colors_.resize(places_.size());
    return cornerColors(colors_, false, bytes_);
  }

  /// Creates a corner for each combination of position and normal.
  void pairUp() {
    TriangleSoup& soup = mesh_.soup;
    std::unordered_map<std::uint64_t, std::uint32_t> corners;
    std::size_t next = 0;
    for (auto& triangle : soup.triangles)
      for (std::uint32_t& corner : triangle) {
        const std::uint32_t place = corner, normal = cornerNormals_[next++];
        const auto [at, isNew] =
            corners.try_emplace(std::uint64_t{place} << 32 | normal, static_cast<std::uint32_t>(soup.corners.size()));
        corner = at->second;
        if (!isNew) continue;
        if (soup.corners.size() == 0xffffffffu) lines_.fail("more than 4,294,967,295 corners");
        soup.corners.push_back(places_[place]);
        soup.normals.emplace_back(normals_[normal]);
        if (!bytes_.empty()) soup.colors.push_back(bytes_[place]);
      }
  }

  MeshLines lines_;
  ImportedMesh mesh_;
  std::vector<DVec3> places_;
  std::vector<Vec3> normals_;
  std::vector<std::optional<DVec3>> colors_;        // by position, up to the last one that has a colour
  std::vector<std::array<std::uint8_t, 4>> bytes_;  // the same for all positions, once complete
  std::vector<std::uint32_t> polygon_, normalsOf_;  // of the current face
  std::vector<DVec3> around_;
  std::vector<std::array<std::uint32_t, 3>> local_;
  std::vector<std::uint32_t> cornerNormals_;  // three for each triangle, as long as all have normals
  bool facing_ = true;
  std::size_t others_ = 0, freeForms_ = 0, unknown_ = 0, large_ = 0;
};

}  // namespace

ImportedMesh importObj(const std::filesystem::path& file) { return ObjReader(file).read(); }

}  // namespace palpate
