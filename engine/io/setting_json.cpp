#include "engine/io/setting_json.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>

#include "engine/core/unknown_name.hpp"

namespace palpate {

namespace {

// Conversion of each type of value. The functions throw ConfigError that names the path.
double number(std::string_view path, const SettingsJson& json) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw ConfigError(path, "is {}, not a number", json.dump());
  return json.get<double>();
}

// Checks the range, since the library would wrap a number that does not fit.
template <std::unsigned_integral T>
T whole(std::string_view path, const SettingsJson& json) {
  const double value = json.is_number() ? json.get<double>() : -1;
  if (!(value >= 0 && value <= static_cast<double>(std::numeric_limits<T>::max()) && std::floor(value) == value))
    throw ConfigError(path, "is {}, not a whole number from 0 to {}", json.dump(), std::numeric_limits<T>::max());
  return json.get<T>();
}

std::string text(std::string_view path, const SettingsJson& json) {
  if (!json.is_string()) throw ConfigError(path, "is {}, not a text", json.dump());
  return json.get<std::string>();
}

void requireList(std::string_view path, const SettingsJson& json, std::size_t count, std::string_view what) {
  if (!json.is_array() || json.size() != count)
    throw ConfigError(path, "is {}, not a list of {} {}", json.dump(), count, what);
}

DVec3 vector(std::string_view path, const SettingsJson& json) {
  requireList(path, json, 3, "numbers");
  return {number(path, json[0]), number(path, json[1]), number(path, json[2])};
}

template <class T>
SettingsJson written(const T& value) {
  return value;
}
SettingsJson written(const DVec3& value) { return {value.x, value.y, value.z}; }
SettingsJson written(double value) {
  return std::isfinite(value) ? SettingsJson(value) : SettingsJson(nullptr);  // JSON has no infinity
}
SettingsJson written(const Corners& value) {
  return value ? SettingsJson{written((*value)[0]), written((*value)[1])} : SettingsJson(nullptr);
}
template <class T>
SettingsJson written(const std::optional<T>& value) {
  return value ? written(*value) : SettingsJson(nullptr);
}

void readTo(std::string_view path, const SettingsJson& json, const Range& range, double& value) {
  value = json.is_null() && range.max == Range::kInfinity ? Range::kInfinity : number(path, json);
}
void readTo(std::string_view path, const SettingsJson& json, const Range&, bool& value) {
  if (!json.is_boolean()) throw ConfigError(path, "is {}, neither true nor false", json.dump());
  value = json.get<bool>();
}
template <std::unsigned_integral T>
void readTo(std::string_view path, const SettingsJson& json, const Range&, T& value) {
  value = whole<T>(path, json);
}
void readTo(std::string_view path, const SettingsJson& json, const Range&, std::string& value) {
  value = text(path, json);
}
void readTo(std::string_view path, const SettingsJson& json, const Range&, std::vector<std::string>& value) {
  if (!json.is_array()) throw ConfigError(path, "is {}, not a list of texts", json.dump());
  value.clear();
  for (const SettingsJson& each : json) value.push_back(text(path, each));
}
void readTo(std::string_view path, const SettingsJson& json, const Range&, DVec3& value) { value = vector(path, json); }
void readTo(std::string_view path, const SettingsJson& json, const Range&, std::array<std::uint8_t, 3>& value) {
  requireList(path, json, value.size(), "numbers");
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = whole<std::uint8_t>(path, json[k]);
}
void readTo(std::string_view path, const SettingsJson& json, const Range&, std::array<DVec3, 2>& value) {
  requireList(path, json, value.size(), "corners of a box");
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = vector(path, json[k]);
}
template <class T>
void readTo(std::string_view path, const SettingsJson& json, const Range& range, std::optional<T>& value) {
  value.reset();
  if (!json.is_null()) readTo(path, json, range, value.emplace());
}

// "tool.mass_kg" is "mass_kg" in "tool".
struct NameInPart {
  std::string part, name;  // `part`: empty for a name without a dot
};
NameInPart inPart(std::string_view name) {
  const std::size_t dot = name.find('.');
  if (dot == name.npos) return {{}, std::string(name)};
  return {std::string(name.substr(0, dot)), std::string(name.substr(dot + 1))};
}

}  // namespace

void requireObject(std::string_view path, const SettingsJson& json) {
  if (!json.is_object()) throw ConfigError(path.empty() ? "config" : path, "is not an object");
}

void requireKnown(std::string_view path, const SettingsJson& json, const std::vector<std::string_view>& known) {
  for (const auto& [key, inside] : json.items()) {
    const std::string name = key, part = name + ".";
    if (std::ranges::find(known, name) != known.end()) continue;
    std::vector<std::string_view> ofPart;
    for (const std::string_view each : known)
      if (each.starts_with(part)) ofPart.push_back(each.substr(part.size()));
    if (ofPart.empty()) throw ConfigError(pathOf(path, name), "{}", unknownName("key", name, known));
    requireObject(pathOf(path, name), inside);
    requireKnown(pathOf(path, name), inside, ofPart);
  }
}

namespace setting_json {

const SettingsJson* find(const SettingsJson& json, std::string_view name) {
  const NameInPart in = inPart(name);
  const SettingsJson* object = &json;
  if (!in.part.empty()) {
    const auto part = json.find(in.part);
    if (part == json.end()) return nullptr;
    object = &*part;
  }
  const auto found = object->find(in.name);
  return found == object->end() ? nullptr : &*found;
}

SettingsJson& make(SettingsJson& json, std::string_view name) {
  const NameInPart in = inPart(name);
  return (in.part.empty() ? json : json[in.part])[in.name];
}

void read(std::string_view path, const SettingsJson& json, const Range& range, const Pointers::In& value) {
  std::visit([&](auto* to) { readTo(path, json, range, *to); }, value);
}

void readWord(std::string_view path, const SettingsJson& json, bool mayBeNull,
              const std::function<bool(const std::string* word)>& choose, std::vector<std::string> (*all)()) {
  if (json.is_null() && mayBeNull) {
    choose(nullptr);
    return;
  }
  const std::string word = text(path, json);
  if (!choose(&word)) throw ConfigError(path, "{}", unknownName("value", word, all()));
}

void write(SettingsJson& json, const Pointers::Out& value) {
  std::visit([&](const auto* from) { json = written(*from); }, value);
}

void writeWord(SettingsJson& json, std::string_view word) {
  json = word.empty() ? SettingsJson(nullptr) : SettingsJson(std::string(word));
}

std::string textOf(const std::function<void(SettingsJson& json)>& write) {
  SettingsJson json;
  write(json);
  return json.dump();
}

}  // namespace setting_json

}  // namespace palpate
