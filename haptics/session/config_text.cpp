// The configuration of a session as JSON text and back. Each field is named once for both directions.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>

#include "haptics/session/session_config.hpp"

namespace palpate {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, bool>, 2> kOnOff{{{"on", true}, {"off", false}}};

template <class Names>
std::string choicesOf(const Names& names) {
  std::string all;
  for (const auto& [name, value] : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return all;
}

/// Writes the fields that a description names.
class Writer {
 public:
  explicit Writer(Json& json) : json_(json) {}

  void field(const char* name, const double& value) const {
    json_[name] = std::isfinite(value) ? Json(value) : Json(nullptr);  // JSON has no infinity
  }
  template <class T>
  void field(const char* name, const T& value) const {
    json_[name] = value;
  }
  template <class T>
  void field(const char* name, const std::optional<T>& value) const {
    json_[name] = value ? Json(*value) : Json(nullptr);
  }
  void field(const char* name, const DVec3& value) const { json_[name] = {value.x, value.y, value.z}; }
  void field(const char* name, const std::optional<DVec3>& value) const {
    json_[name] = nullptr;
    if (value) field(name, *value);
  }
  // Two corners of a box.
  void field(const char* name, const std::optional<std::array<DVec3, 2>>& value) const {
    json_[name] = nullptr;
    if (!value) return;
    const auto& [low, high] = *value;
    json_[name] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
  }
  template <class T, class Names>
  void field(const char* name, const T& value, const Names& names) const {
    for (const auto& [known, each] : names)
      if (each == value) json_[name] = known;
  }
  template <class T, class Names>
  void field(const char* name, const std::optional<T>& value, const Names& names) const {
    json_[name] = nullptr;
    if (value) field(name, *value, names);
  }
  template <class Part, class Describe>
  void part(const char* name, const Part& value, Describe&& describe) const {
    json_[name] = Json::object();
    describe(Writer(json_[name]), value);
  }
  template <class Part, class Describe>
  void part(const char* name, const std::optional<Part>& value, Describe&& describe) const {
    json_[name] = nullptr;
    if (value) part(name, *value, describe);
  }
  // The same, but an absent part is not written.
  template <class Part, class Describe>
  void partWhereGiven(const char* name, const std::optional<Part>& value, Describe&& describe) const {
    if (value) part(name, *value, describe);
  }
  template <class Part, class Describe>
  void parts(const char* name, const std::vector<Part>& values, Describe&& describe) const {
    json_[name] = Json::array();
    for (const Part& value : values) describe(Writer(json_[name].emplace_back(Json::object())), value);
  }

 private:
  Json& json_;
};

/// Reads the fields that a description names; an absent field keeps its default. Fields that no description has named
/// in the end are unknown.
class Reader {
 public:
  Reader(const Json& json, std::string path) : json_(json), path_(std::move(path)) {
    if (!json.is_object()) throw ConfigError(path_.empty() ? "config" : path_, "is not an object");
  }

  void field(const char* name, double& value) {
    take(name, [&](const Json& json) {
      value = json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
    });
  }
  void field(const char* name, bool& value) {
    take(name, [&](const Json& json) { json.get_to(value); });
  }
  void field(const char* name, std::string& value) {
    take(name, [&](const Json& json) { json.get_to(value); });
  }
  void field(const char* name, std::vector<std::string>& value) {
    take(name, [&](const Json& json) { json.get_to(value); });
  }
  template <std::integral T>
  void field(const char* name, T& value) {
    take(name, [&](const Json& json) { value = wholeOf<T>(name, json); });
  }
  template <std::integral T, std::size_t n>
  void field(const char* name, std::array<T, n>& value) {
    take(name, [&](const Json& json) {
      const auto numbers = json.get<std::array<Json, n>>();
      std::ranges::transform(numbers, value.begin(), [&](const Json& each) { return wholeOf<T>(name, each); });
    });
  }
  void field(const char* name, std::optional<double>& value) {
    take(name, [&](const Json& json) {
      value.reset();
      if (!json.is_null()) value = json.get<double>();
    });
  }
  template <std::integral T>
  void field(const char* name, std::optional<T>& value) {
    take(name, [&](const Json& json) {
      value.reset();
      if (!json.is_null()) value = wholeOf<T>(name, json);
    });
  }
  void field(const char* name, DVec3& value) {
    take(name, [&](const Json& json) {
      const auto xyz = json.get<std::array<double, 3>>();
      value = {xyz[0], xyz[1], xyz[2]};
    });
  }
  void field(const char* name, std::optional<DVec3>& value) {
    value.reset();
    const auto found = json_.find(name);
    if (found == json_.end() || found->is_null())
      known_.emplace_back(name);
    else
      field(name, value.emplace());
  }
  void field(const char* name, std::optional<std::array<DVec3, 2>>& value) {
    take(name, [&](const Json& json) {
      value.reset();
      if (json.is_null()) return;
      const auto corners = json.get<std::array<std::array<double, 3>, 2>>();
      value.emplace();
      for (std::size_t k = 0; k < 2; ++k) (*value)[k] = {corners[k][0], corners[k][1], corners[k][2]};
    });
  }
  template <class T, class Names>
  void field(const char* name, T& value, const Names& names) {
    take(name, [&](const Json& json) { value = valueOf(name, json, names); });
  }
  template <class T, class Names>
  void field(const char* name, std::optional<T>& value, const Names& names) {
    take(name, [&](const Json& json) {
      value.reset();
      if (!json.is_null()) value = valueOf(name, json, names);
    });
  }
  template <class Part, class Describe>
  void part(const char* name, Part& value, Describe&& describe) {
    take(name, [&](const Json& json) {
      Reader reader(json, at(name));
      describe(reader, value);
      reader.finish();
    });
  }
  template <class Part, class Describe>
  void part(const char* name, std::optional<Part>& value, Describe&& describe) {
    take(name, [&](const Json& json) {
      value.reset();
      if (json.is_null()) return;
      Reader reader(json, at(name));
      describe(reader, value.emplace());
      reader.finish();
    });
  }
  template <class Part, class Describe>
  void partWhereGiven(const char* name, std::optional<Part>& value, Describe&& describe) {
    part(name, value, describe);
  }
  template <class Part, class Describe>
  void parts(const char* name, std::vector<Part>& values, Describe&& describe) {
    take(name, [&](const Json& json) {
      values.clear();
      for (const Json& each : json.get<std::vector<Json>>()) {
        Reader reader(each, fmt::format("{}[{}]", at(name), values.size()));
        describe(reader, values.emplace_back());
        reader.finish();
      }
    });
  }
  void finish() const {
    for (const auto& [name, value] : json_.items())
      if (std::ranges::find(known_, name) == known_.end()) throw ConfigError(at(name), "is not known here");
  }

 private:
  std::string at(std::string_view name) const {
    return path_.empty() ? std::string(name) : path_ + "." + std::string(name);
  }

  template <class Take>
  void take(const char* name, Take&& take) {
    known_.emplace_back(name);
    const auto found = json_.find(name);
    if (found == json_.end()) return;
    try {
      take(*found);
    } catch (const nlohmann::json::exception&) {
      throw ConfigError(at(name), "cannot be {}", found->dump());
    }
  }
  // Checks the range, since the library would wrap a number that does not fit.
  template <class T>
  T wholeOf(const char* name, const Json& json) const {
    const auto number = json.get<double>();
    if (!(number >= 0 && number <= static_cast<double>(std::numeric_limits<T>::max()) && std::floor(number) == number))
      throw ConfigError(at(name), "cannot be {}", json.dump());
    return json.get<T>();
  }
  template <class Names>
  auto valueOf(const char* name, const Json& json, const Names& names) const {
    const auto text = json.get<std::string>();
    for (const auto& [known, value] : names)
      if (known == text) return value;
    throw ConfigError(at(name), "cannot be '{}'; there is {}", text, choicesOf(names));
  }

  const Json& json_;
  std::string path_;
  std::vector<std::string> known_;
};

// The fields of each part, for a Writer and a Reader alike.

void describe(auto&& in, auto& config, const ModelConfig*) {
  in.field("file", config.file);
  in.field("mm_per_unit", config.mm_per_unit);
  in.field("normals", config.normals, kNormalSources);
  in.field("all_points", config.allPoints);
}

void describe(auto&& in, auto& config, const BackendConfig*) {
  in.field("name", config.name);
  in.field("method", config.method);
  in.field("deterministic", config.deterministic);
  in.field("wait", config.wait, kWaits);
  in.field("ahead", config.ahead, kOnOff);
  in.field("times_passes", config.timesPasses);
}

void describe(auto&& in, auto& config, const IndexConfig*) {
  in.field("follow", config.follow, kIndexFollows);
  in.field("bucket_key", config.bucketKey, kBucketKeys);
  in.field("sort", config.sort, kSortMethods);
  in.field("cell_mm", config.cell_mm);
  in.field("cells_along_side", config.cellsAlongSide);
  in.field("spare_slots", config.spareSlots);
}

void describe(auto&& in, auto& config, const SurfaceConfig*) {
  in.field("kind", config.kind, kSurfaceKinds);
  in.field("friction", config.friction);
  in.field("radius_mm", config.radius_mm);
}

void describe(auto&& in, auto& config, const ToolConfig*) {
  in.field("kind", config.kind, kToolKinds);
  in.field("points", config.points);
  in.field("size_mm", config.size_mm);
  in.field("axis", config.axis);
}

void describe(auto&& in, auto& config, const BrushConfig*) {
  in.field("kind", config.kind, kBrushKinds);
  in.field("tau_mm", config.tau_mm);
  in.field("beta", config.beta);
  in.field("radius_mm", config.radius_mm);
  in.field("strength", config.strength);
  in.field("falloff", config.falloff);
  in.field("color", config.color);
  in.field("keeps_density", config.keepsDensity);
}

void describe(auto&& in, auto& config, const ForceOptions*) {
  in.field("stiffness_N_per_mm", config.stiffness_N_per_mm);
  in.field("damping_N_s_per_mm", config.damping_N_s_per_mm);
  in.field("max_N", config.maxForce_N);
  in.field("max_rise_N_per_s", config.maxRise_N_per_s);
  in.field("max_surface_power_W", config.maxSurfacePower_W);
}

void describe(auto&& in, auto& config, const HandConfig*) {
  in.field("device", config.device);
  in.field("path", config.path);
  in.field("penetration_mm", config.penetration_mm);
  in.field("fit", config.fit, kWorkspaceFits);
  in.field("passivity", config.passivity, kPassivityModes);
  in.field("stiffness_N_per_mm", config.stiffness_N_per_mm);
  in.field("damping_N_s_per_mm", config.damping_N_s_per_mm);
  in.field("own_scheduler", config.ownScheduler);
  in.field("rumbles", config.rumbles);
}

void describe(auto&& in, auto& config, const MotionConfig*) {
  in.field("kind", config.kind, kMotionKinds);
  in.field("axis", config.axis);
  in.field("amplitude_mm", config.amplitude_mm);
  in.field("frequency_Hz", config.frequency_Hz);
  in.field("speed_mm_per_s", config.speed_mm_per_s);
}

void describe(auto&& in, auto& config, const StreamConfig*) {
  in.field("live", config.live);
  in.field("speed", config.speed);
  in.field("loop", config.loop);
  in.field("fuse", config.fuse);
  in.field("depth_scale", config.depthScale);
  in.field("intrinsics", config.intrinsics);
}

void describe(auto&& in, auto& config, const JoinConfig*) {
  in.field("network", config.network);
  in.field("peers", config.peers);
  in.field("domain", config.domain);
  in.field("security", config.security);
  in.field("near", config.near);
}

void describe(auto&& in, auto& config, const MatterTool*) {
  in.field("radius_mm", config.radius_mm);
  in.field("mass_kg", config.mass_kg);
}

template <class Part>
constexpr auto describer = [](auto&& in, auto& part) { describe(in, part, static_cast<const Part*>(nullptr)); };

void describe(auto&& in, auto& config, const MatterScene*) {
  in.field("matter", config.matter, kMatters);
  in.field("box_mm", config.box_mm);
  in.field("fill_mm", config.fill_mm);
  in.field("fill_at_mm", config.fill_at_mm);
  in.field("spacing_mm", config.spacing_mm);
  in.field("density_kg_m3", config.density_kg_m3);
  in.field("viscosity_Pa_s", config.viscosity_Pa_s);
  in.field("cohesion_N_m", config.cohesion_N_m);
  in.field("friction", config.friction);
  in.field("young_Pa", config.young_Pa);
  in.field("poisson", config.poisson);
  in.field("preset", config.preset, kSoftPresets);
  in.field("stiffness", config.stiffness);
  in.field("shape", config.shape, kSoftShapes);
  in.field("model", config.model);
  in.field("model_mm", config.model_mm);
  in.field("model_at_mm", config.model_at_mm);
  in.field("hole_mm", config.hole_mm);
  in.field("pinned_mm", config.pinned_mm);
  in.field("gravity_m_s2", config.gravity_m_s2);
  in.field("substeps", config.substeps);
  in.part("tool", config.tool, describer<MatterTool>);
  in.field("gain", config.gain);
}

void describe(auto&& in, auto& config, const UndoConfig*) {
  in.field("undo", config.undo);
  in.field("redo", config.redo);
  in.field("memory_MiB", config.memory_MiB);
}

void describeSession(auto&& in, auto& config) {
  in.part("model", config.model, describer<ModelConfig>);
  in.part("backend", config.backend, describer<BackendConfig>);
  in.part("index", config.index, describer<IndexConfig>);
  in.part("surface", config.surface, describer<SurfaceConfig>);
  in.part("tool", config.tool, describer<ToolConfig>);
  in.part("brush", config.brush, describer<BrushConfig>);
  in.part("force", config.force, describer<ForceOptions>);
  in.part("undo", config.undo, describer<UndoConfig>);
  in.partWhereGiven("motion", config.motion, describer<MotionConfig>);
  in.partWhereGiven("stream", config.stream, describer<StreamConfig>);
  in.partWhereGiven("join", config.join, describer<JoinConfig>);
  in.partWhereGiven("matter", config.matter, describer<MatterScene>);
  in.parts("hands", config.hands, describer<HandConfig>);
  in.field("rate_Hz", config.rate_Hz);
  in.field("duration_s", config.duration_s);
  in.field("realtime", config.realtime);
}

}  // namespace

std::string configText(const SessionConfig& config) {
  Json json{{"version", SessionConfig::kVersion}};
  describeSession(Writer(json), config);
  return json.dump(1);
}

namespace {

Json parsed(std::string_view text) {
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    throw Error("the configuration is not valid JSON: {}", error.what());
  }
}

}  // namespace

std::string sceneText(const MatterScene& scene) {
  Json json;
  describe(Writer(json), scene, static_cast<const MatterScene*>(nullptr));
  return json.dump();
}

MatterScene parseScene(std::string_view text) {
  const Json json = parsed(text);
  Reader reader(json, "");
  SessionConfig config{.matter = MatterScene{}};
  describe(reader, *config.matter, static_cast<const MatterScene*>(nullptr));
  reader.finish();
  validate(config);
  return *config.matter;
}

SessionConfig parseConfig(std::string_view text) {
  const Json json = parsed(text);
  int version = 0;
  Reader reader(json, "");
  reader.field("version", version);
  if (version != SessionConfig::kVersion)
    throw ConfigError("version", "is {}; this palpate reads {}", version, SessionConfig::kVersion);
  SessionConfig config;
  describeSession(reader, config);
  reader.finish();
  validate(config);
  return config;
}

}  // namespace palpate
