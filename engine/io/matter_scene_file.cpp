#include "engine/io/matter_scene_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/matter/matter_model.hpp"

namespace palpate {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxSceneFile = std::size_t{1} << 20;  // bytes

// Name and reader of a field, the kinds of matter that have it, and the preset of soft bodies that has it.
struct Field {
  const char* name;
  void (*read)(const Field& field, const Json& value, MatterScene& scene);
  bool ofWater = true, ofSand = true, ofSoft = true, needed = false;
  std::optional<SoftPreset> preset = std::nullopt;

  bool isOf(Matter matter) const {
    return matter == Matter::water ? ofWater : matter == Matter::sand ? ofSand : ofSoft;
  }
};

double numberOf(std::string_view name, const Json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw Error("{}: is {}, which is no number", name, inQuotes(value.dump()));
  return value.get<double>();
}

DVec3 vectorOf(const Field& field, const Json& value) {
  if (!value.is_array() || value.size() != 3) throw Error("{}: is no list of 3 numbers", field.name);
  return {numberOf(field.name, value[0]), numberOf(field.name, value[1]), numberOf(field.name, value[2])};
}

template <double MatterScene::*member>
void readNumber(const Field& field, const Json& value, MatterScene& scene) {
  scene.*member = numberOf(field.name, value);
}

template <DVec3 MatterScene::*member>
void readVector(const Field& field, const Json& value, MatterScene& scene) {
  scene.*member = vectorOf(field, value);
}

void readSubsteps(const Field& field, const Json& value, MatterScene& scene) {
  const double number = numberOf(field.name, value);
  if (!(number >= 0 && number <= 1e6 && number == std::floor(number)))
    throw Error("substeps: is {}; it is a whole number, 0 for as many as the scene needs", number);
  scene.substeps = static_cast<std::uint32_t>(number);
}

void readTool(const Field&, const Json& value, MatterScene& scene) {
  if (!value.is_object()) throw Error("tool: is no object with radius_mm and mass_kg");
  for (const auto& [name, inside] : value.items()) {
    const std::string full = "tool." + name;
    if (name == "radius_mm")
      scene.tool.radius_mm = numberOf(full, inside);
    else if (name == "mass_kg")
      scene.tool.mass_kg = numberOf(full, inside);
    else
      throw Error("tool: {} is not known; there are radius_mm and mass_kg", inQuotes(name));
  }
}

void readModel(const Field&, const Json& value, MatterScene& scene) {
  if (!value.is_string() || value.get<std::string>().empty())
    throw Error("model: is {}, which is no name of a file", inQuotes(value.dump()));
  scene.model = value.get<std::string>();
}

void readModelPlace(const Field& field, const Json& value, MatterScene& scene) {
  scene.model_at_mm = vectorOf(field, value);
}

void readShape(const Field&, const Json& value, MatterScene& scene) {
  const auto shape = value.is_string() ? valueNamed(kSoftShapes, value.get<std::string>()) : std::nullopt;
  if (!shape) throw Error("shape: is {}; there are {}", inQuotes(value.dump()), fmt::join(namesOf(kSoftShapes), ", "));
  scene.shape = *shape;
}

void readPreset(const Field&, const Json& value, MatterScene& scene) {
  const auto preset = value.is_string() ? valueNamed(kSoftPresets, value.get<std::string>()) : std::nullopt;
  if (!preset)
    throw Error("preset: is {}; there are {}", inQuotes(value.dump()), fmt::join(namesOf(kSoftPresets), ", "));
  scene.preset = *preset;
}

void readPinned(const Field& field, const Json& value, MatterScene& scene) {
  if (!value.is_array() || value.size() != 2) throw Error("{}: is no list of 2 corners of a box", field.name);
  scene.pinned_mm = {vectorOf(field, value[0]), vectorOf(field, value[1])};
}

void readMatter(const Field&, const Json& value, MatterScene& scene) {
  const auto matter = value.is_string() ? valueNamed(kMatters, value.get<std::string>()) : std::nullopt;
  if (!matter) throw Error("matter: is {}; there are {}", inQuotes(value.dump()), fmt::join(namesOf(kMatters), ", "));
  scene.matter = *matter;
  if (scene.matter == Matter::soft) scene.viscosity_Pa_s = kSoftViscosity_Pa_s;
}

constexpr std::array kFields{
    Field{.name = "matter", .read = readMatter, .needed = true},
    Field{.name = "box_mm", .read = readVector<&MatterScene::box_mm>, .needed = true},
    Field{.name = "fill_mm", .read = readVector<&MatterScene::fill_mm>, .needed = true},
    Field{.name = "fill_at_mm", .read = readVector<&MatterScene::fill_at_mm>, .ofSoft = false},
    Field{.name = "spacing_mm", .read = readNumber<&MatterScene::spacing_mm>, .needed = true},
    Field{.name = "density_kg_m3", .read = readNumber<&MatterScene::density_kg_m3>},
    Field{.name = "viscosity_Pa_s",
          .read = readNumber<&MatterScene::viscosity_Pa_s>,
          .ofSand = false,
          .preset = SoftPreset::elastic},
    Field{.name = "cohesion_N_m", .read = readNumber<&MatterScene::cohesion_N_m>, .ofSand = false, .ofSoft = false},
    Field{.name = "friction", .read = readNumber<&MatterScene::friction>, .ofWater = false},
    Field{.name = "preset", .read = readPreset, .ofWater = false, .ofSand = false},
    Field{.name = "young_Pa",
          .read = readNumber<&MatterScene::young_Pa>,
          .ofWater = false,
          .ofSand = false,
          .preset = SoftPreset::elastic},
    Field{.name = "poisson",
          .read = readNumber<&MatterScene::poisson>,
          .ofWater = false,
          .ofSand = false,
          .preset = SoftPreset::elastic},
    Field{.name = "stiffness",
          .read = readNumber<&MatterScene::stiffness>,
          .ofWater = false,
          .ofSand = false,
          .preset = SoftPreset::shapeMatching},
    Field{.name = "shape", .read = readShape, .ofWater = false, .ofSand = false},
    Field{.name = "model", .read = readModel},
    Field{.name = "model_mm", .read = readVector<&MatterScene::model_mm>, .ofSoft = false},
    Field{.name = "model_at_mm", .read = readModelPlace, .ofSoft = false},
    Field{.name = "hole_mm", .read = readNumber<&MatterScene::hole_mm>},
    Field{.name = "pinned_mm", .read = readPinned, .ofWater = false, .ofSand = false},
    Field{.name = "gravity_m_s2", .read = readVector<&MatterScene::gravity_m_s2>},
    Field{.name = "substeps", .read = readSubsteps},
    Field{.name = "tool", .read = readTool},
    Field{.name = "gain", .read = readNumber<&MatterScene::gain>},
};

// In the order of the parsed keys, which is alphabetical, so that the same file gives the same error.
void readFields(const Json& object, MatterScene& scene) {
  for (const auto& [name, value] : object.items()) {
    const auto* const field = std::ranges::find(kFields, name, &Field::name);
    if (field == kFields.end()) {
      std::vector<std::string_view> names;
      names.reserve(std::size(kFields));
      for (const Field& known : kFields) names.emplace_back(known.name);
      throw Error("{}: is not known; there are {}", inQuotes(name), fmt::join(names, ", "));
    }
    if (!field->isOf(scene.matter)) throw Error("{}: belongs to no scene of {}", name, nameOf(kMatters, scene.matter));
    field->read(*field, value, scene);
  }
  if (scene.matter != Matter::soft) return;
  for (const Field& field : kFields)
    if (field.preset && *field.preset != scene.preset && object.contains(field.name))
      throw Error("{}: belongs to no soft body of preset {}{}", field.name, nameOf(kSoftPresets, scene.preset),
                  scene.preset == SoftPreset::shapeMatching ? ", which is not calibrated" : "");
}

}  // namespace

MatterScene parseMatterScene(std::string_view json) {
  const Json parsed = Json::parse(json, nullptr, false);
  if (parsed.is_discarded()) throw Error("is no JSON");
  if (!parsed.is_object()) throw Error("is no JSON object");
  for (const Field& field : kFields)
    if (field.needed && !parsed.contains(field.name)) throw Error("{}: is not there", field.name);
  MatterScene scene;
  readMatter(kFields.front(), parsed["matter"], scene);
  readFields(parsed, scene);
  return scene;
}

MatterScene readMatterScene(const std::filesystem::path& file) {
  ChunkedFile in(file);
  const auto bytes = in.peek(kMaxSceneFile + 1);
  if (bytes.size() > kMaxSceneFile) throw FileError(file, "is too long for a scene of matter");
  try {
    MatterScene scene = parseMatterScene({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!scene.model.empty() && !isBuiltInModel(scene.model)) scene.model = (file.parent_path() / scene.model).string();
    planOf(scene);
    return scene;
  } catch (const Error& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace palpate
