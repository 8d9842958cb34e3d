#include "haptics/session/flag_migration.hpp"

#include <charconv>
#include <functional>
#include <map>

#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

using Set = std::function<void(SessionConfig&, const std::string&)>;

template <class T>
T number(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end) throw Error("'{}' is not a number", text);
  return value;
}

bool truth(const std::string& text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  throw Error("'{}' is neither true nor false", text);
}

template <class T, std::size_t n>
std::array<T, n> list(std::string_view text) {
  std::array<T, n> values{};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t comma = i + 1 < n ? text.find(',') : text.size();
    if (comma == std::string_view::npos) throw Error("'{}' is not a list of {} numbers", text, n);
    values[i] = number<T>(text.substr(0, comma));
    text.remove_prefix(std::min(text.size(), comma + 1));
  }
  return values;
}

template <class Names>
auto named(const Names& names, const std::string& text) {
  if (const auto value = valueNamed(names, text)) return *value;
  throw Error("'{}' is not a valid choice", text);
}

// The brush had an option for each part, whether or not there was a brush.
BrushConfig& brush(SessionConfig& config) { return config.brush ? *config.brush : config.brush.emplace(); }

const std::map<std::string_view, Set>& setters() {
  using C = SessionConfig;
  using S = const std::string&;
  static const std::map<std::string_view, Set> all{
      {"--mm-per-unit", [](C& c, S v) { c.model.mm_per_unit = number<double>(v); }},
      {"--normals", [](C& c, S v) { c.model.normals = named(kNormalSources, v); }},
      {"--rate", [](C& c, S v) { c.rate_Hz = number<double>(v); }},
      {"--realtime", [](C& c, S v) { c.realtime = truth(v); }},
      {"--stiffness", [](C& c, S v) { c.force.stiffness_N_per_mm = number<double>(v); }},
      {"--damping", [](C& c, S v) { c.force.damping_N_s_per_mm = number<double>(v); }},
      {"--max-force", [](C& c, S v) { c.force.maxForce_N = number<double>(v); }},
      {"--surface",
       [](C& c, S v) {
         if (!v.empty()) c.surface.kind = named(kSurfaceKinds, v);
       }},
      {"--friction", [](C& c, S v) { c.surface.friction = number<double>(v); }},
      {"--radius",
       [](C& c, S v) {
         if (v != "auto") c.surface.radius_mm = number<double>(v);
       }},
      {"--tau", [](C& c, S v) { brush(c).tau_mm = number<double>(v); }},
      {"--beta", [](C& c, S v) { brush(c).beta = number<double>(v); }},
      {"--strength", [](C& c, S v) { brush(c).strength = number<double>(v); }},
      {"--falloff", [](C& c, S v) { brush(c).falloff = number<std::uint32_t>(v); }},
      {"--paint-color", [](C& c, S v) { brush(c).color = list<std::uint8_t, 3>(v); }},
      {"--keep-points", [](C& c, S v) { brush(c).keepsDensity = !truth(v); }},
      {"--tool-radius", [](C& c, S v) { brush(c).radius_mm = number<double>(v); }},
      {"--undo", [](C& c, S v) { c.undo.undo = number<std::size_t>(v); }},
      {"--redo", [](C& c, S v) { c.undo.redo = number<std::size_t>(v); }},
      {"--undo-memory", [](C& c, S v) { c.undo.memory_MiB = number<double>(v); }},
      {"--backend", [](C& c, S v) { c.backend.name = v; }},
      {"--method", [](C& c, S v) { c.backend.method = v; }},
      {"--deterministic", [](C& c, S v) { c.backend.deterministic = truth(v); }},
      {"--wait",
       [](C& c, S v) {
         if (!v.empty()) c.backend.wait = named(kWaits, v);
       }},
      {"--ahead",
       [](C& c, S v) {
         if (v != "auto") c.backend.ahead = v == "on";
       }},
      {"--index", [](C& c, S v) { c.index.follow = named(kIndexFollows, v); }},
      {"--bucket-key", [](C& c, S v) { c.index.bucketKey = named(kBucketKeys, v); }},
      {"--sort", [](C& c, S v) { c.index.sort = named(kSortMethods, v); }},
      {"--cell", [](C& c, S v) { c.index.cell_mm = number<double>(v); }},
      {"--grid", [](C& c, S v) { c.index.cellsAlongSide = number<double>(v); }},
      {"--tool", [](C& c, S v) { c.tool.kind = named(kToolKinds, v); }},
      {"--tool-points", [](C& c, S v) { c.tool.points = number<std::size_t>(v); }},
      {"--tool-size", [](C& c, S v) { c.tool.size_mm = number<double>(v); }},
      {"--tool-axis",
       [](C& c, S v) {
         const auto axis = list<double, 3>(v);
         c.tool.axis = {axis[0], axis[1], axis[2]};
       }},
      {"--rumble", [](C&, S) {}},  // concerned only the gamepad
  };
  return all;
}

}  // namespace

SessionConfig migrateFlags(const std::map<std::string, std::string>& flags) {
  SessionConfig config;
  config.hands.clear();  // a log does not tell the source of its poses
  std::string edit = "none";
  for (const auto& [flag, value] : flags) {
    if (flag == "--edit") {
      edit = value;
      continue;
    }
    const auto found = setters().find(flag);
    if (found == setters().end()) throw Error("{} is not an option of a session", flag);
    found->second(config, value);
  }
  if (edit == "none")
    config.brush.reset();
  else
    brush(config).kind = named(kBrushKinds, edit);
  validate(config);
  return config;
}

}  // namespace palpate
