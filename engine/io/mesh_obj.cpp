#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/core/counted.hpp"
#include "engine/core/vec.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/mesh_lines.hpp"
#include "engine/io/polygon.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

namespace {

// Materials of OBJ (MTL): their colours and textures.
struct ObjMaterial {
  std::string name;
  std::optional<DVec3> color = {};      ///< Kd, 0 to 1
  std::optional<Texture> texture = {};  ///< map_Kd
  Vec2 scale{1}, shift{0};              ///< of coordinates of the texture
  bool isUsed = false;
  std::uint32_t number = kNoTexture;  ///< index of the texture among those of the mesh

  /// Many programs write a grey Kd beside a texture that is not to be darkened.
  DVec3 shown() const {
    const DVec3 own = color.value_or(DVec3(1));
    return texture && own.x == own.y && own.y == own.z ? DVec3(1) : own;
  }
};

/// Reads the options of map_Kd; the name of the picture, which may contain blanks, follows them.
void readTexture(const MeshLines& lines, const std::filesystem::path& folder, ObjMaterial& material) {
  const auto& words = lines.words();
  Texture& texture = material.texture.emplace();
  std::size_t k = 1;
  while (k + 1 < words.size() && words[k].size() > 1 && words[k][0] == '-') {
    const std::string_view option = words[k++];
    if (option == "-s" || option == "-o" || option == "-t") {
      for (int axis = 0; axis < 3 && k + 1 < words.size(); ++axis, ++k) {
        const auto value = textNumber<float>(words[k]);
        if (!value) break;
        if (axis < 2 && option != "-t") (option == "-s" ? material.scale : material.shift)[axis] = *value;
      }
    } else {
      if (option == "-clamp" && words[k] == "on") texture.wrapU = texture.wrapV = TextureWrap::clamp;
      k += option == "-mm" ? 2 : 1;
    }
  }
  texture.name = lines.behind(std::min(k, words.size() - 1));
  texture.file = textureBeside(folder, texture.name);
}

/// Materials may be repeated. Throws FileError.
std::vector<ObjMaterial> readObjMaterials(const std::filesystem::path& file) {
  std::vector<ObjMaterial> materials;
  MeshLines lines(file);
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.front() == "newmtl")
      materials.push_back({.name = lines.behind(1)});
    else if (words.front() == "Kd" && !materials.empty() && words.size() >= 4 && textNumber<double>(words[1]))
      materials.back().color = lines.three(1, "a colour");
    else if (words.front() == "map_Kd" && !materials.empty() && words.size() > 1)
      readTexture(lines, file.parent_path(), materials.back());
  }
  return materials;
}

class ObjReader {
 public:
  explicit ObjReader(const std::filesystem::path& file) : folder_(file.parent_path()), lines_(file, kPaint) {}

  ImportedMesh read() {
    while (lines_.next()) {
      const std::string_view word = lines_.words().front();
      if (word == "v") {
        vertex();
      } else if (word == "vn") {
        normals_.emplace_back(lines_.three(1, "a normal"));
      } else if (word == "vt") {
        uv_.push_back(coordinates());
      } else if (word == "f" || word == "fo") {
        face();
      } else if (word == "usemtl") {
        current_ = materialNamed(lines_.behind(1));
      } else if (word == "mtllib") {
        library();
      } else if (word == kPaint) {
        paint();
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
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::string_view kPaint = "#MRGB";  // polypaint of ZBrush, in comments
  static constexpr std::string_view kFreeForms[] = {"curv", "curv2", "surf"};
  static constexpr std::string_view kPassedOver[] = {
      "vp",       "o",        "g",          "s",         "mg",    "usemap", "maplib", "bevel", "lod",
      "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech",  "cstype", "deg",   "bmat",
      "step",     "parm",     "trim",       "hole",      "scrv",  "sp",     "end",    "con",   "call"};

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

  /// Coordinates of a texture; one that is missing or not a number is 0.
  Vec2 coordinates() const {
    Vec2 uv(0);
    for (std::size_t k = 0; k < 2 && k + 1 < lines_.words().size(); ++k)
      uv[static_cast<int>(k)] = textNumber<float>(lines_.words()[k + 1]).value_or(0);
    return uv;
  }

  std::size_t materialNamed(const std::string& name) {
    const auto found = std::ranges::find(materials_, name, &ObjMaterial::name);
    const auto index = static_cast<std::size_t>(found - materials_.begin());
    if (found == materials_.end()) materials_.push_back({.name = name});
    return index;
  }

  void library() {
    std::string name = lines_.behind(1);
    std::ranges::replace(name, '\\', '/');
    std::error_code ignored;
    const std::filesystem::path file = folder_ / name;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      missing_ = name;
      return;
    }
    for (ObjMaterial& material : readObjMaterials(file)) {
      ObjMaterial& known = materials_[materialNamed(material.name)];
      if (material.color) known.color = material.color;
      if (!material.texture) continue;
      known.texture = std::move(material.texture);
      known.scale = material.scale, known.shift = material.shift;
    }
  }

  /// Eight hexadecimal digits for each of the next corners: a material, red, green, blue.
  void paint() {
    const std::string_view digits = lines_.words().size() > 1 ? lines_.words()[1] : std::string_view();
    for (std::size_t at = 0; at + 8 <= digits.size(); at += 8) {
      std::uint32_t bits = 0;
      const auto [stop, error] = std::from_chars(digits.data() + at, digits.data() + at + 8, bits, 16);
      if (error != std::errc{} || stop != digits.data() + at + 8) lines_.fail("a colour of #MRGB is not hexadecimal");
      paint_.push_back({static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
                        static_cast<std::uint8_t>(bits), 255});
    }
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

  /// As referred(); kNone if there is no such coordinate, as some programs write.
  std::uint32_t referredUv(std::string_view text) const {
    const std::int64_t number = textNumber<std::int64_t>(text).value_or(0);
    const auto count = static_cast<std::int64_t>(uv_.size());
    const std::int64_t index = number < 0 ? number + count : number - 1;
    return index < 0 || index >= count ? kNone : static_cast<std::uint32_t>(index);
  }

  void face() {
    polygon_.clear();
    normalsOf_.clear();
    uvOf_.clear();
    for (std::size_t k = 1; k < lines_.words().size(); ++k) {
      const std::string_view word = lines_.words()[k];
      const std::size_t first = word.find('/');
      polygon_.push_back(referred(word.substr(0, first), places_.size(), "corner"));
      const std::size_t second = first == word.npos ? first : word.find('/', first + 1);
      uvOf_.push_back(first == word.npos ? kNone : referredUv(word.substr(first + 1, second - first - 1)));
      const std::string_view normal = second == word.npos ? std::string_view() : word.substr(second + 1);
      if (!normal.empty() && normal != "0")  // both are written for a missing one
        normalsOf_.push_back(referred(normal, normals_.size(), "normal"));
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
      materialOf_.push_back(static_cast<std::uint32_t>(current_));
      if (!uv_.empty()) {
        cornerUv_.resize(mesh_.soup.triangles.size() - 1, {kNone, kNone, kNone});
        cornerUv_.push_back({uvOf_[a], uvOf_[b], uvOf_[c]});
      }
      if (facing_) cornerNormals_.insert(cornerNormals_.end(), {normalsOf_[a], normalsOf_[b], normalsOf_[c]});
    }
  }

  ImportedMesh finish() {
    TriangleSoup& soup = mesh_.soup;
    const std::size_t uncolored = settleColors();
    if (uncolored > 0) mesh_.lost.push_back(fmt::format("{} corners have no colour, and are white", uncolored));
    facing_ = facing_ && !cornerNormals_.empty();
    if (!facing_ && !cornerNormals_.empty()) mesh_.lost.emplace_back("normals, which some corners lack");
    if (const bool byMaterial = settleMaterials(); facing_ || byMaterial) {
      pairUp(byMaterial);
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
    if (!paint_.empty() && colors_.empty() && paint_.size() == places_.size())
      bytes_ = std::move(paint_);
    else if (!paint_.empty())
      mesh_.lost.push_back(
          fmt::format("the paint (#MRGB) of {} of {}", paint_.size(), counted(places_.size(), "corner")));
    if (colors_.empty()) return 0;
    colors_.resize(places_.size());
    return cornerColors(colors_, false, bytes_);
  }

  /// Whether colours are those of materials: if corners have none, and they are not all the same grey.
  bool settleMaterials() {
    for (const std::uint32_t material : materialOf_)
      if (material < materials_.size()) materials_[material].isUsed = true;
    if (!missing_.empty() && std::ranges::any_of(materials_, &ObjMaterial::isUsed))
      mesh_.lost.push_back(fmt::format("the materials of {}, which is missing", inQuotes(missing_)));
    const bool haveColors = !bytes_.empty() || !colors_.empty();
    std::optional<DVec3> one;
    bool anyColor = false;
    for (ObjMaterial& material : materials_) {
      if (!material.isUsed) continue;
      if (material.texture) addTexture(material, haveColors);
      const DVec3 color = material.shown();
      anyColor = anyColor || color.x != color.y || color.y != color.z || (one && *one != color);
      one = color;
    }
    if (!mesh_.soup.textures.empty()) settleTextures();
    return anyColor && !haveColors;
  }

  void addTexture(ObjMaterial& material, bool haveColors) {
    if (haveColors) {
      mesh_.lost.push_back(lostTexture(material.texture->name, "corners have colours"));
    } else {
      std::vector<Texture>& textures = mesh_.soup.textures;
      const auto same = std::ranges::find_if(textures, [&](const Texture& known) {
        return known.file == material.texture->file && known.wrapU == material.texture->wrapU;
      });
      material.number = static_cast<std::uint32_t>(same - textures.begin());
      if (same == textures.end()) textures.push_back(*material.texture);
    }
  }

  /// Triangles without coordinates have the colour of their material alone.
  void settleTextures() {
    TriangleSoup& soup = mesh_.soup;
    cornerUv_.resize(soup.triangles.size(), {kNone, kNone, kNone});
    soup.textured.resize(soup.triangles.size());
    std::size_t without = 0;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      const ObjMaterial* material = materialOf_[t] < materials_.size() ? &materials_[materialOf_[t]] : nullptr;
      if (!material || material->number == kNoTexture) continue;
      if (std::ranges::count(cornerUv_[t], kNone) > 0) {
        ++without;
        continue;
      }
      soup.textured[t].texture = material->number;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 uv = uv_[cornerUv_[t][k]] * material->scale + material->shift;
        soup.textured[t].uv[k] = {uv.x, 1 - uv.y};  // OBJ counts v from the bottom
      }
    }
    if (std::ranges::all_of(soup.textured, [](const auto& corners) { return corners.texture == kNoTexture; }))
      soup.textures.clear(), soup.textured.clear();
    if (without > 0)
      mesh_.lost.push_back(fmt::format("the texture of {} without coordinates", counted(without, "triangle")));
  }

  struct Corner {
    std::uint32_t place, normal, material;
    bool operator==(const Corner&) const = default;
  };
  struct HashCorner {
    std::size_t operator()(const Corner& c) const {
      return std::hash<std::uint64_t>{}((std::uint64_t{c.place} << 32 | c.normal) ^
                                        std::uint64_t{c.material} * 0x9e3779b97f4a7c15u);
    }
  };

  /// Creates a corner for each combination of position, normal and, if colours are those of materials, material.
  void pairUp(bool byMaterial) {
    TriangleSoup& soup = mesh_.soup;
    std::unordered_map<Corner, std::uint32_t, HashCorner> corners;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& corner = soup.triangles[t][k];
        const Corner key{corner, facing_ ? cornerNormals_[3 * t + k] : 0, byMaterial ? materialOf_[t] : 0};
        const auto [at, isNew] = corners.try_emplace(key, static_cast<std::uint32_t>(soup.corners.size()));
        corner = at->second;
        if (!isNew) continue;
        if (soup.corners.size() == 0xffffffffu) lines_.fail("more than 4,294,967,295 corners");
        soup.corners.push_back(places_[key.place]);
        if (facing_) soup.normals.emplace_back(normals_[key.normal]);
        if (byMaterial)
          soup.colors.push_back(colorOf(key.material));
        else if (!bytes_.empty())
          soup.colors.push_back(bytes_[key.place]);
      }
  }

  std::array<std::uint8_t, 4> colorOf(std::size_t material) const {
    const DVec3 color = material < materials_.size() ? materials_[material].shown() : DVec3(1);
    return {colorByte(color.x, 1), colorByte(color.y, 1), colorByte(color.z, 1), 255};
  }

  std::filesystem::path folder_;
  MeshLines lines_;
  ImportedMesh mesh_;
  std::vector<DVec3> places_;
  std::vector<Vec3> normals_;
  std::vector<std::optional<DVec3>> colors_;        // by position, up to the last one that has a colour
  std::vector<std::array<std::uint8_t, 4>> bytes_;  // the same for all positions, once complete
  std::vector<Vec2> uv_;
  std::vector<std::uint32_t> polygon_, normalsOf_, uvOf_;  // of the current face
  std::vector<DVec3> around_;
  std::vector<std::array<std::uint32_t, 3>> local_;
  std::vector<std::uint32_t> cornerNormals_;            // three for each triangle, as long as all have normals
  std::vector<std::array<std::uint32_t, 3>> cornerUv_;  // by triangle, up to the last face that has coordinates
  bool facing_ = true;
  std::vector<ObjMaterial> materials_;
  std::string missing_;                    // file of materials
  std::size_t current_ = 0xffffffffu;      // index of the material in use; none at first
  std::vector<std::uint32_t> materialOf_;  // by triangle
  std::vector<std::array<std::uint8_t, 4>> paint_;
  std::size_t others_ = 0, freeForms_ = 0, unknown_ = 0, large_ = 0;
};

}  // namespace

ImportedMesh importObj(const std::filesystem::path& file) { return ObjReader(file).read(); }

}  // namespace palpate
