#include <algorithm>
#include <array>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/counted.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/gltf_file.hpp"
#include "engine/io/mesh_import.hpp"

namespace palpate {

namespace {

using Json = nlohmann::json;
using DMat3 = glm::dmat3;

constexpr unsigned kMaxNodeDepth = 1000;  // maximum nesting of nodes

struct Placement {
  DMat3 turn{1};
  DVec3 shift{0};

  Placement operator*(const Placement& inner) const { return {turn * inner.turn, turn * inner.shift + shift}; }
  /// Transformation of normals for any scale: the cofactor matrix, with the sign that preserves the side.
  DMat3 ofNormals() const {
    const DMat3 cofactors(glm::cross(turn[1], turn[2]), glm::cross(turn[2], turn[0]), glm::cross(turn[0], turn[1]));
    return isMirrored() ? -1.0 * cofactors : cofactors;
  }
  bool isMirrored() const { return glm::determinant(turn) < 0; }
};

class GltfReader {
 public:
  explicit GltfReader(const std::filesystem::path& path) : file_(path), shown_(nodes().size(), false) {}

  ImportedMesh read() {
    refuseUnreadable();
    settleAttributes();
    for (const Json& node : roots()) show(node, {}, 0);
    settleColors();
    if (others_ > 0) mesh_.lost.push_back(fmt::format("{} points and lines", others_));
    if (const std::size_t count = list("animations").size(); count > 0)
      mesh_.lost.push_back(fmt::format("{} animations", count));
    if (const std::size_t count = list("skins").size(); count > 0)
      mesh_.lost.push_back(fmt::format("the motion of {} skeletons", count));
    return std::move(mesh_);
  }

 private:
  const Json& list(const char* name) const { return listOf(file_.json(), name); }
  const Json& nodes() const { return list("nodes"); }
  /// Empty if missing.
  const Json& listOf(const Json& object, const char* name) const {
    static const Json none = Json::array();
    const auto found = object.find(name);
    if (found == object.end()) return none;
    if (!found->is_array()) file_.fail(fmt::format("\"{}\" is not a list", name));
    return *found;
  }

  void refuseUnreadable() const {
    for (const Json& extension : list("extensionsRequired"))
      for (const char* packed : kPacked)
        if (extension == packed) refusePacked(packed);
  }
  [[noreturn]] void refusePacked(std::string_view extension) const {
    const bool draco = extension.find("draco") != extension.npos;
    file_.fail(fmt::format("is compressed {}({}), which is not read; export it without compression, or as PLY or OBJ",
                           draco ? "with Draco " : "", extension));
  }

  /// The root nodes of the scene; without a scene those that are not children.
  std::vector<Json> roots() const {
    if (!list("scenes").empty()) {
      const Json& scene = file_.named("scenes", Json(file_.whole(file_.json(), "scene", 0)));
      const Json& first = listOf(scene, "nodes");
      return {first.begin(), first.end()};
    }
    std::vector<bool> isChild(nodes().size(), false);
    for (const Json& node : nodes())
      if (node.is_object())
        for (const Json& child : listOf(node, "children"))
          if (child.is_number_unsigned() && child.get<std::size_t>() < isChild.size())
            isChild[child.get<std::size_t>()] = true;
    std::vector<Json> roots;
    for (std::size_t k = 0; k < isChild.size(); ++k)
      if (!isChild[k]) roots.emplace_back(k);
    return roots;
  }

  /// Normals are used if all triangles have them, colours if any has them. Without any triangle, points are read.
  void settleAttributes() {
    const auto eachPrimitive = [&](auto&& visit) {
      for (const Json& mesh : list("meshes")) {
        if (!mesh.is_object()) file_.fail("\"meshes\" has an entry that is not an object");
        for (const Json& primitive : listOf(mesh, "primitives")) visit(primitive, attributesOf(primitive));
      }
    };
    eachPrimitive([&](const Json& primitive, const Json&) { points_ = points_ && !hasTriangles(primitive); });
    eachPrimitive([&](const Json& primitive, const Json& attributes) {
      if (!isTaken(primitive)) return;
      if (const auto extensions = primitive.find("extensions"); extensions != primitive.end())
        for (const char* packed : kPacked)
          if (extensions->is_object() && extensions->contains(packed)) refusePacked(packed);
      normals_ = normals_ && attributes.contains("NORMAL");
      colors_ = colors_ || attributes.contains("COLOR_0");
    });
  }
  bool isTaken(const Json& primitive) const {
    return points_ ? file_.whole(primitive, "mode", kTriangles) == kPoints : hasTriangles(primitive);
  }
  Json attributesOf(const Json& primitive) const {
    if (!primitive.is_object()) file_.fail("\"primitives\" has an entry that is not an object");
    const auto found = primitive.find("attributes");
    if (found == primitive.end() || !found->is_object()) file_.fail("a part of a mesh has no \"attributes\"");
    return *found;
  }
  bool hasTriangles(const Json& primitive) const {
    const std::size_t mode = file_.whole(primitive, "mode", kTriangles);
    return mode >= kTriangles && mode <= kFan;
  }

  void show(const Json& number, const Placement& above, unsigned depth) {
    if (depth > kMaxNodeDepth) file_.fail(fmt::format("nodes are nested more than {} deep", kMaxNodeDepth));
    const Json& node = file_.named("nodes", number);
    const auto which = number.get<std::size_t>();
    if (shown_[which]) file_.fail(fmt::format("node {} is a duplicate", which));
    shown_[which] = true;
    const Placement here = above * placementOf(node);
    if (node.contains("mesh"))
      for (const Json& primitive : listOf(file_.named("meshes", node["mesh"]), "primitives")) add(primitive, here);
    for (const Json& child : listOf(node, "children")) show(child, here, depth + 1);
  }

  std::vector<double> numbersIn(const Json& node, const char* name, std::vector<double> otherwise) const {
    const auto found = node.find(name);
    if (found == node.end()) return otherwise;
    const bool right = found->is_array() && found->size() == otherwise.size() &&
                       std::ranges::all_of(*found, [](const Json& number) { return number.is_number(); });
    if (!right) file_.fail(fmt::format("\"{}\" of a node is not a list of {} numbers", name, otherwise.size()));
    return found->get<std::vector<double>>();
  }

  Placement placementOf(const Json& node) const {
    Placement placement;
    if (node.contains("matrix")) {
      const std::vector<double> m = numbersIn(node, "matrix", std::vector<double>(16));
      for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
          placement.turn[column][row] = m[4 * static_cast<std::size_t>(column) + static_cast<std::size_t>(row)];
      placement.shift = {m[12], m[13], m[14]};
      return placement;
    }
    const std::vector<double> t = numbersIn(node, "translation", {0, 0, 0}), s = numbersIn(node, "scale", {1, 1, 1}),
                              r = numbersIn(node, "rotation", {0, 0, 0, 1});
    const DQuat turn(r[3], r[0], r[1], r[2]);
    for (int column = 0; column < 3; ++column) {
      DVec3 axis(0);
      axis[column] = s[static_cast<std::size_t>(column)];
      placement.turn[column] = turn * axis;
    }
    placement.shift = {t[0], t[1], t[2]};
    return placement;
  }

  void add(const Json& primitive, const Placement& here) {
    const Json attributes = attributesOf(primitive);
    const std::size_t mode = file_.whole(primitive, "mode", kTriangles);
    if (!attributes.contains("POSITION")) file_.fail("a part of a mesh has no \"POSITION\"");
    const GltfNumbers places = file_.numbers(attributes["POSITION"], {3});
    if (!isTaken(primitive)) {
      others_ += primitive.contains("indices") ? file_.numbers(primitive["indices"], {1}).count : places.count;
      return;
    }
    TriangleSoup& soup = mesh_.soup;
    const std::size_t first = soup.corners.size();
    if (first + places.count > 0xffffffffu) file_.fail("more than 4,294,967,295 corners");
    for (std::size_t i = 0; i < places.count; ++i) soup.corners.push_back(here.turn * threeOf(places, i) + here.shift);
    if (normals_) addNormals(numbersLike(places, attributes["NORMAL"], {3}), here.ofNormals());
    if (colors_ && attributes.contains("COLOR_0"))
      addColors(numbersLike(places, attributes["COLOR_0"], {3, 4}));
    else if (colors_)
      raw_.resize(soup.corners.size());
    if (points_) return;
    if (primitive.contains("indices")) {
      const GltfNumbers indices = file_.numbers(primitive["indices"], {1});
      if (indices.kind != 5121 && indices.kind != 5123 && indices.kind != 5125)
        file_.fail("data of corners have a type that is not allowed for them");
      addTriangles(indices.count, mode, here.isMirrored(), first, places.count,
                   [&](std::size_t k) { return indices.index(k); });
    } else {
      addTriangles(places.count, mode, here.isMirrored(), first, places.count,
                   [](std::size_t k) { return static_cast<std::uint32_t>(k); });
    }
  }

  GltfNumbers numbersLike(const GltfNumbers& places, const Json& accessor, std::initializer_list<unsigned> perElement) {
    const GltfNumbers numbers = file_.numbers(accessor, perElement);
    if (numbers.count != places.count)
      file_.fail(fmt::format("{} normals or colours of {}", numbers.count, counted(places.count, "corner")));
    return numbers;
  }
  static DVec3 threeOf(const GltfNumbers& numbers, std::size_t i) {
    return {numbers.number(i, 0), numbers.number(i, 1), numbers.number(i, 2)};
  }
  void addNormals(const GltfNumbers& normals, const DMat3& turn) {
    for (std::size_t i = 0; i < normals.count; ++i) mesh_.soup.normals.emplace_back(turn * threeOf(normals, i));
  }
  void addColors(const GltfNumbers& colors) {
    const double full = colors.normalized || colors.kind == kFloat ? 1 : colors.kind == kByte ? 255 : 65535;
    for (std::size_t i = 0; i < colors.count; ++i) raw_.emplace_back(threeOf(colors, i) / full);
  }
  /// Corners without a colour become white if others have one.
  void settleColors() {
    if (!colors_) return;
    const std::size_t missing = cornerColors(raw_, false, mesh_.soup.colors);
    if (missing > 0) mesh_.lost.push_back(fmt::format("{} corners have no colour, and are white", missing));
  }

  /// `corner`: maps 0 to `count` - 1 to a corner index below `there`; `first` is added to it.
  template <class Corner>
  void addTriangles(std::size_t count, std::size_t mode, bool mirrored, std::size_t first, std::size_t there,
                    Corner&& corner) {
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t k = 0; k + 2 < count; k += step) {
      std::array<std::uint32_t, 3> triangle{corner(mode == kFan ? 0 : k), corner(k + 1), corner(k + 2)};
      if ((mode == kStrip && k % 2 == 1) != mirrored) std::swap(triangle[1], triangle[2]);
      for (std::uint32_t& number : triangle) {
        if (number >= there)
          file_.fail(
              fmt::format("a triangle refers to corner {}, counted from 0, but there are only {}", number, there));
        number += static_cast<std::uint32_t>(first);
      }
      mesh_.soup.triangles.push_back(triangle);
    }
  }

  static constexpr std::size_t kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6;  // numbers of glTF
  static constexpr unsigned kByte = 5121, kFloat = 5126;
  static constexpr std::array<const char*, 2> kPacked{"KHR_draco_mesh_compression", "EXT_meshopt_compression"};

  GltfFile file_;
  ImportedMesh mesh_;
  std::vector<bool> shown_;
  bool points_ = true, normals_ = true, colors_ = false;
  std::vector<std::optional<DVec3>> raw_;  // colours of corners
  std::size_t others_ = 0;
};

}  // namespace

ImportedMesh importGltf(const std::filesystem::path& file) { return GltfReader(file).read(); }

}  // namespace palpate
