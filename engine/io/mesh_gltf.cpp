#include <algorithm>
#include <array>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/counted.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/gltf_parts.hpp"
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
  explicit GltfReader(const std::filesystem::path& path)
      : file_(path), parts_(file_), textures_(file_), shown_(nodes().size(), false) {}

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

  /// An extension that a file requires, and that changes more than colours and lights, must be known.
  void refuseUnreadable() {
    for (const Json& extension : list("extensionsRequired")) {
      const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
      const bool isAppearance =
          name.starts_with("KHR_materials_") || name.starts_with("KHR_lights") || name.find("_texture_") != name.npos;
      if (isAppearance || std::ranges::find(kKnown, name) != kKnown.end()) continue;
      file_.fail(
          fmt::format("requires the extension {}, which is not read; export it without, or as PLY or OBJ", name));
    }
    for (const Json& extension : list("extensionsUsed"))
      if (extension == kGaussians) mesh_.lost.push_back("the shapes of Gaussians (KHR_gaussian_splatting)");
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
      normals_ = normals_ && attributes.contains("NORMAL");
      colors_ = colors_ || attributes.contains("COLOR_0");
      takeMaterial(primitive);
    });
    if (textured_ > 0) mesh_.soup.textures = textures_.textures();
    mesh_.lost.insert(mesh_.lost.end(), textures_.lost().begin(), textures_.lost().end());
    if (untextured_ > 0)
      mesh_.lost.push_back(fmt::format("the texture of {} without coordinates", counted(untextured_, "part")));
    byMaterial_ = (byMaterial_ || !mesh_.soup.textures.empty()) && !colors_;
  }

  /// The material of a part of a mesh, without its textures; null without a material.
  const Json* surfaceOf(const Json& primitive) const {
    if (!primitive.contains("material")) return nullptr;
    const Json& material = file_.named("materials", primitive["material"]);
    const auto found = material.find("pbrMetallicRoughness");
    return found != material.end() && found->is_object() ? &*found : nullptr;
  }
  /// The texture of a part that has coordinates for it.
  std::optional<GltfTexture> textureOf(const Json& primitive) {
    const Json* surface = surfaceOf(primitive);
    if (points_ || !surface || !surface->contains("baseColorTexture")) return std::nullopt;
    std::optional<GltfTexture> texture = textures_.of((*surface)["baseColorTexture"]);
    return texture && primitive["attributes"].contains(texture->coordinates) ? texture : std::nullopt;
  }
  /// Colours are those of materials unless they are all the same grey.
  void takeMaterial(const Json& primitive) {
    const Json* surface = surfaceOf(primitive);
    if (surface && surface->contains("baseColorTexture") && textures_.of((*surface)["baseColorTexture"]))
      ++(textureOf(primitive) ? textured_ : untextured_);
    const auto color = colorOf(primitive);
    const bool isGrey = color[0] == color[1] && color[1] == color[2];
    byMaterial_ = byMaterial_ || !isGrey || (oneColor_ && *oneColor_ != color);
    oneColor_ = color;
  }
  /// The base colour, which glTF stores in linear light.
  std::array<std::uint8_t, 4> colorOf(const Json& primitive) const {
    const DVec3 linear = factorOf(primitive);
    return {srgbByte(linear.x), srgbByte(linear.y), srgbByte(linear.z), 255};
  }
  DVec3 factorOf(const Json& primitive) const {
    const Json* surface = surfaceOf(primitive);
    if (!surface) return DVec3(1);
    const std::vector<double> factor = numbersIn(*surface, "baseColorFactor", {1, 1, 1, 1});
    return {factor[0], factor[1], factor[2]};
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
      for (const Placement& instance : instancesOf(node))
        for (const Json& primitive : listOf(file_.named("meshes", node["mesh"]), "primitives"))
          add(primitive, here * instance);
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
    return placed({t[0], t[1], t[2]}, DQuat(r[3], r[0], r[1], r[2]), {s[0], s[1], s[2]});
  }
  static Placement placed(const DVec3& shift, const DQuat& turn, const DVec3& scale) {
    Placement placement{.shift = shift};
    for (int column = 0; column < 3; ++column) {
      DVec3 axis(0);
      axis[column] = scale[column];
      placement.turn[column] = turn * axis;
    }
    return placement;
  }

  /// Where EXT_mesh_gpu_instancing shows the mesh of a node, relative to it; once without it.
  std::vector<Placement> instancesOf(const Json& node) {
    const Json* extension = file_.extension(node, kInstances);
    if (!extension) return {{}};
    const Json attributes = extension->value("attributes", Json::object());
    if (!attributes.is_object()) file_.fail("\"attributes\" of instances are not an object");
    std::optional<GltfNumbers> shifts, turns, scales;
    std::size_t count = 0;
    const auto take = [&](const char* name, std::optional<GltfNumbers>& numbers, unsigned perElement) {
      if (!attributes.contains(name)) return;
      numbers = file_.numbers(attributes[name], {perElement});
      if (count > 0 && numbers->count != count) file_.fail("attributes of instances differ in number");
      count = numbers->count;
    };
    take("TRANSLATION", shifts, 3);
    take("ROTATION", turns, 4);
    take("SCALE", scales, 3);
    std::vector<Placement> instances;
    for (std::size_t i = 0; i < count; ++i) {
      const DQuat turn = turns
                             ? DQuat(turns->number(i, 3), turns->number(i, 0), turns->number(i, 1), turns->number(i, 2))
                             : DQuat(1, 0, 0, 0);
      instances.push_back(
          placed(shifts ? threeOf(*shifts, i) : DVec3(0), turn, scales ? threeOf(*scales, i) : DVec3(1)));
    }
    return instances;
  }

  void add(const Json& primitive, const Placement& here) {
    const Json attributes = attributesOf(primitive);
    const std::size_t mode =
        file_.extension(primitive, GltfParts::kDraco) ? kTriangles : file_.whole(primitive, "mode", kTriangles);
    if (!attributes.contains("POSITION")) file_.fail("a part of a mesh has no \"POSITION\"");
    const GltfNumbers places = parts_.attribute(primitive, "POSITION", {3});
    const std::optional<GltfNumbers> indices = parts_.indices(primitive);
    if (!isTaken(primitive)) {
      others_ += indices ? indices->count : places.count;
      return;
    }
    TriangleSoup& soup = mesh_.soup;
    const std::size_t first = soup.corners.size(), firstTriangle = soup.triangles.size();
    if (first + places.count > 0xffffffffu) file_.fail("more than 4,294,967,295 corners");
    for (std::size_t i = 0; i < places.count; ++i) soup.corners.push_back(here.turn * threeOf(places, i) + here.shift);
    if (normals_) addNormals(numbersLike(places, primitive, "NORMAL", {3}), here.ofNormals());
    const std::optional<GltfTexture> texture = textureOf(primitive);
    if (colors_ && attributes.contains("COLOR_0"))
      addColors(numbersLike(places, primitive, "COLOR_0", {3, 4}), texture.has_value(), factorOf(primitive));
    else if (colors_)
      raw_.resize(soup.corners.size(), texture ? std::optional(shownLinear(factorOf(primitive))) : std::nullopt);
    if (byMaterial_) soup.colors.resize(soup.corners.size(), colorOf(primitive));
    if (points_) return;
    if (indices) {
      if (indices->kind != 5121 && indices->kind != 5123 && indices->kind != 5125)
        file_.fail("data of corners have a type that is not allowed for them");
      addTriangles(indices->count, mode, here.isMirrored(), first, places.count,
                   [&](std::size_t k) { return indices->index(k); });
    } else {
      addTriangles(places.count, mode, here.isMirrored(), first, places.count,
                   [](std::size_t k) { return static_cast<std::uint32_t>(k); });
    }
    if (soup.textures.empty()) return;
    soup.textured.resize(soup.triangles.size());
    if (texture)
      addCoordinates(numbersLike(places, primitive, texture->coordinates.c_str(), {2}), *texture, first, firstTriangle);
  }

  void addCoordinates(const GltfNumbers& uv, const GltfTexture& texture, std::size_t first, std::size_t firstTriangle) {
    TriangleSoup& soup = mesh_.soup;
    for (std::size_t t = firstTriangle; t < soup.triangles.size(); ++t) {
      soup.textured[t].texture = texture.number;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = soup.triangles[t][k] - first;
        soup.textured[t].uv[k] = texture.transformed({uv.number(i, 0), uv.number(i, 1)});
      }
    }
  }

  GltfNumbers numbersLike(const GltfNumbers& places, const Json& primitive, const char* name,
                          std::initializer_list<unsigned> perElement) {
    const GltfNumbers numbers = parts_.attribute(primitive, name, perElement);
    if (numbers.count != places.count)
      file_.fail(fmt::format("{} values of {} of {}", numbers.count, name, counted(places.count, "corner")));
    return numbers;
  }
  static DVec3 threeOf(const GltfNumbers& numbers, std::size_t i) {
    return {numbers.number(i, 0), numbers.number(i, 1), numbers.number(i, 2)};
  }
  void addNormals(const GltfNumbers& normals, const DMat3& turn) {
    for (std::size_t i = 0; i < normals.count; ++i) mesh_.soup.normals.emplace_back(turn * threeOf(normals, i));
  }
  /// `factor`: of a textured part, which multiplies them in linear light; others are shown as they are.
  void addColors(const GltfNumbers& colors, bool textured, const DVec3& factor) {
    const double full = colors.normalized || colors.kind == kFloat ? 1 : colors.kind == kByte ? 255 : 65535;
    for (std::size_t i = 0; i < colors.count; ++i) {
      const DVec3 color = threeOf(colors, i) / full;
      raw_.emplace_back(textured ? shownLinear(color * factor) : color);
    }
  }
  static DVec3 shownLinear(const DVec3& linear) {
    return DVec3(srgbByte(linear.x), srgbByte(linear.y), srgbByte(linear.z)) / 255.0;
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
  static constexpr const char *kInstances = "EXT_mesh_gpu_instancing", *kGaussians = "KHR_gaussian_splatting";
  static constexpr std::array<std::string_view, 5> kKnown{kInstances, "KHR_mesh_quantization", kGaussians,
                                                          "KHR_draco_mesh_compression", "EXT_meshopt_compression"};

  GltfFile file_;
  GltfParts parts_;
  GltfTextures textures_;
  ImportedMesh mesh_;
  std::vector<bool> shown_;
  bool points_ = true, normals_ = true, colors_ = false, byMaterial_ = false;
  std::optional<std::array<std::uint8_t, 4>> oneColor_;  // of the materials so far
  std::vector<std::optional<DVec3>> raw_;                // colours of corners
  std::size_t others_ = 0, textured_ = 0, untextured_ = 0;
};

}  // namespace

ImportedMesh importGltf(const std::filesystem::path& file) { return GltfReader(file).read(); }

}  // namespace palpate
