#include "haptics/session/session_config.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "haptics/devices/device_axes.hpp"
#include "haptics/session/abilities.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

// Checks the bounds of each section by its table.
struct BoundsCheck {
  template <class Section>
  void operator()(std::string_view path, const Section& section, Presence = Presence::always) const {
    forEachBounded(settingsOf<Section>(), section, [&](const Setting<Section>& setting, double value) {
      if (!setting.range.contains(value)) requireIn(setting.range, pathOf(path, setting.name), value);
    });
  }
  template <class Section>
  void operator()(std::string_view path, const std::optional<Section>& section, Presence) const {
    if (section) (*this)(path, *section);
  }
};

void requireDirection(std::string_view path, const DVec3& axis) {
  if (!isFinite(axis) || !(glm::length(axis) > 0)) throw ConfigError(path, "is not a direction");
}

void validate(const StreamConfig& stream, const SessionConfig& config) {
  if (config.model.normals != NormalSource::keep)
    throw ConfigError("model.normals", "the frames of a depth camera have their own; leave it at keep");
  if (!stream.live) return;
  if (stream.speed != 1) throw ConfigError("stream.speed", "a live stream has no playback speed; leave it out");
  if (stream.loop) throw ConfigError("stream.loop", "a live stream cannot restart; leave it out");
  if (!config.realtime) throw ConfigError("realtime", "live streams require realtime");
}

void validateJoined(const SessionConfig& config) {
  constexpr std::size_t kLongestName = 200;  // bytes, of a session
  if (config.model.file.empty() || config.model.file.size() > kLongestName)
    throw ConfigError("model.file", "is not a valid session name (1 to {} bytes)", kLongestName);
  if (config.model.normals != NormalSource::keep)
    throw ConfigError("model.normals", "a joined model has its own normals; leave it at keep");
  if (config.model.keepUnreliable)
    throw ConfigError("model.keep_unreliable", "the server chooses the points of a joined model; leave it out");
}

void validatePrepared(const ModelConfig& model) {
  if (model.stream || model.join || model.matter)
    throw ConfigError("prepare",
                      "only the points of a file are selected and cleaned, not those of a stream, a joined "
                      "session or a scene; leave {} out",
                      "--crop, --where, --outliers and such");
}

}  // namespace

SymmetryPlane symmetryPlane(std::string_view text, const DVec3& middle) {
  constexpr std::string_view kAxes = "xyz", kPath = "brush.symmetry";
  SymmetryPlane plane{.place = middle};
  if (const std::size_t axis = kAxes.find(text); text.size() == 1 && axis != std::string_view::npos) {
    plane.normal = DVec3(0);
    plane.normal[static_cast<int>(axis)] = 1;
    return plane;
  }
  std::array<double, 6> numbers{};
  std::size_t count = 0;
  for (std::size_t begin = 0; begin <= text.size() && count <= numbers.size(); ++count) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (count < numbers.size()) {
      const auto [last, error] = std::from_chars(text.data() + begin, text.data() + end, numbers[count]);
      if (error != std::errc() || last != text.data() + end || !std::isfinite(numbers[count])) break;
    }
    begin = end + 1;
  }
  if (count != numbers.size())
    throw ConfigError(kPath, "is '{}'; it is x, y or z, or a position on the plane and its normal: PX,PY,PZ,NX,NY,NZ",
                      text);
  plane = {.place = {numbers[0], numbers[1], numbers[2]}, .normal = {numbers[3], numbers[4], numbers[5]}};
  requireDirection(kPath, plane.normal);
  plane.normal = glm::normalize(plane.normal);
  return plane;
}

void validate(const Preparation& preparation) { BoundsCheck()("prepare", preparation); }

void validate(const SessionConfig& config) {
  constexpr BoundsCheck check;
  visitSections(config, check);
  for (std::size_t i = 0; i < config.hands.size(); ++i) {
    const std::string path = fmt::format("hands[{}]", i);
    if (config.hands[i].device.empty()) throw ConfigError(path + ".device", "is not named");
    check(path, config.hands[i]);
    if (const std::string complaint = axesComplaint(config.hands[i].axes); !complaint.empty())
      throw ConfigError(path + ".axes", "{}", complaint);
  }
  check("", config);
  requireDirection("tool.axis", config.tool.axis);
  if (config.motion) requireDirection("motion.axis", config.motion->axis);
  checkAbilities(config);
  if (config.brush && !config.brush->symmetry.empty()) symmetryPlane(config.brush->symmetry, DVec3(0));
  if (config.model.stream) validate(*config.model.stream, config);
  if (config.model.join) validateJoined(config);
  if (config.model.join && (config.model.stream || config.model.matter))
    throw ConfigError("join", "the model is a stream or a scene of matter; leave it out");
  if (config.model.matter) config.model.matter->check(config);
  if (config.model.prepare) validatePrepared(config.model);
}

BrushOptions brushOptions(const BrushConfig& brush, const ModelScale& scale) {
  return {.kind = brush.kind,
          .yieldDepth = scale.toUnits(brush.yieldDepth_mm),
          .pushRate = brush.pushRate,
          .radius = scale.toUnits(brush.radius_mm),
          .strength = brush.strength,
          .falloff = brush.falloff,
          .color = {brush.color[0], brush.color[1], brush.color[2], 255},
          .resample = brush.resample,
          .accumulate = brush.accumulate};
}

ToolShape toolShape(const ToolConfig& tool, const ModelScale& scale) {
  if (tool.kind == ToolKind::point) return {};
  ToolShape shape = makeTool(tool.kind, tool.points, scale.toUnits(tool.size_mm));
  if (shape.points.size() == 1) return {};
  return facing(std::move(shape), tool.axis);
}

std::uint64_t undoBytes(const UndoConfig& undo) {
  constexpr double kMiB = 1 << 20, kMax = 1e18;
  return undo.undo > 0 ? static_cast<std::uint64_t>(std::min(kMax, undo.memory_MiB * kMiB)) : 0;
}

}  // namespace palpate
