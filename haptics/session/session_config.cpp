#include "haptics/session/session_config.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/session/abilities.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

namespace {

void inBounds(std::string_view field, double value, double least, double most) {
  if (!(value >= least && value <= most)) throw ConfigError(field, "{} is not between {} and {}", value, least, most);
}

// 0: the program chooses.
void inBoundsOrZero(std::string_view field, double value, double least, double most) {
  if (value != 0) inBounds(field, value, least, most);
}

void validate(const IndexConfig& index) {
  inBoundsOrZero("index.cell_mm", index.cell_mm, bounds::kShortest_mm, bounds::kLongest_mm);
  inBoundsOrZero("index.cells_along_side", index.cellsAlongSide, 1, bounds::kMaxCells);
  if (index.cell_mm != 0 && index.cellsAlongSide != 0)
    throw ConfigError("index.cells_along_side", "conflicts with index.cell_mm; leave one of them 0");
}

void validate(const ToolConfig& tool) {
  inBounds("tool.points", static_cast<double>(tool.points), 1, static_cast<double>(kMaxToolPoints));
  inBounds("tool.size_mm", tool.size_mm, bounds::kShortest_mm, bounds::kLongest_mm);
  if (!isFinite(tool.axis) || !(glm::length(tool.axis) > 0)) throw ConfigError("tool.axis", "is not a direction");
}

void validate(const BrushConfig& brush) {
  inBounds("brush.tau_mm", brush.tau_mm, 0, bounds::kLongest_mm);
  inBounds("brush.beta", brush.beta, 0, 1);
  inBounds("brush.radius_mm", brush.radius_mm, bounds::kShortest_mm, bounds::kLongest_mm);
  inBounds("brush.strength", brush.strength, 0, 1);
  inBounds("brush.falloff", brush.falloff, 0, kMaxFalloff);
}

void validate(const ForceOptions& force) {
  inBounds("force.stiffness_N_per_mm", force.stiffness_N_per_mm, 0, bounds::kMaxStiffness_N_per_mm);
  inBounds("force.damping_N_s_per_mm", force.damping_N_s_per_mm, 0, bounds::kMaxDamping_N_s_per_mm);
  inBounds("force.max_N", force.maxForce_N, 0, bounds::kMaxForce_N);
  if (!(force.maxRise_N_per_s > 0)) throw ConfigError("force.max_rise_N_per_s", "is not above 0");
  if (!(force.maxSurfacePower_W > 0 && force.maxSurfacePower_W <= bounds::kMaxSurfacePower_W))
    throw ConfigError("force.max_surface_power_W", "is {}, not above 0 and at most {}", force.maxSurfacePower_W,
                      bounds::kMaxSurfacePower_W);
}

void validate(const HandConfig& hand, std::size_t number) {
  const auto at = [&](std::string_view field) { return fmt::format("hands[{}].{}", number, field); };
  if (hand.device.empty()) throw ConfigError(at("device"), "is not named");
  inBounds(at("penetration_mm"), hand.penetration_mm, bounds::kShortest_mm, bounds::kLongest_mm);
  inBoundsOrZero(at("stiffness_N_per_mm"), hand.stiffness_N_per_mm, bounds::kMinStiffness_N_per_mm,
                 bounds::kMaxStiffness_N_per_mm);
  inBoundsOrZero(at("damping_N_s_per_mm"), hand.damping_N_s_per_mm, bounds::kMinDamping_N_s_per_mm,
                 bounds::kMaxDamping_N_s_per_mm);
}

void validate(const MotionConfig& motion) {
  if (!isFinite(motion.axis) || !(glm::length(motion.axis) > 0)) throw ConfigError("motion.axis", "is not a direction");
  inBounds("motion.amplitude_mm", motion.amplitude_mm, 0, bounds::kLongest_mm);
  inBounds("motion.frequency_Hz", motion.frequency_Hz, 0, bounds::kMaxRate_Hz);
  inBounds("motion.speed_mm_per_s", motion.speed_mm_per_s, 0, bounds::kLongest_mm);
}

void validate(const StreamConfig& stream, const SessionConfig& config) {
  inBounds("stream.speed", stream.speed, bounds::kMinSpeed, bounds::kMaxSpeed);
  inBoundsOrZero("stream.depth_scale", stream.depthScale, bounds::kMinDepthScale, bounds::kMaxDepthScale);
  if (config.model.normals != NormalSource::keep)
    throw ConfigError("model.normals", "the frames of a depth camera have their own; leave it at keep");
  if (!stream.live) return;
  if (stream.speed != 1) throw ConfigError("stream.speed", "a live stream has no playback speed; leave it out");
  if (stream.loop) throw ConfigError("stream.loop", "a live stream cannot restart; leave it out");
  if (!config.realtime) throw ConfigError("realtime", "live streams require realtime");
}

void validate(const JoinConfig& join, const SessionConfig& config) {
  constexpr std::size_t kLongestName = 200;  // bytes, of a session
  if (config.model.file.empty() || config.model.file.size() > kLongestName)
    throw ConfigError("model.file", "is not a valid session name (1 to {} bytes)", kLongestName);
  if (join.domain > bounds::kLastDomain)
    throw ConfigError("join.domain", "is {}, not between 0 and {}", join.domain, bounds::kLastDomain);
  if (config.model.normals != NormalSource::keep)
    throw ConfigError("model.normals", "a joined model has its own normals; leave it at keep");
  if (config.model.allPoints)
    throw ConfigError("model.all_points", "the server chooses the points of a joined model; leave it out");
}

// A brush smaller than a cell has no cell of its own to move.
void validateOnSoft(const BrushConfig& brush, const MatterScene& scene, double mm_per_unit) {
  const double least_mm = scene.spacing_mm * (mm_per_unit > 0 ? mm_per_unit : 1);
  if (brush.radius_mm < least_mm)
    throw ConfigError("brush.radius_mm",
                      "is {:g}; the cells of the body are {:g} mm wide, and the brush must not be smaller",
                      brush.radius_mm, least_mm);
}

void validate(const MatterScene& scene, const SessionConfig& config) {
  try {
    planOf(scene);
  } catch (const Error& error) {
    throw ConfigError("matter", "{}", error.what());
  }
  if (scene.periodic != MatterScene{}.periodic)
    throw ConfigError("matter.periodic", "requires a simulation without a hand");
  if (config.stream) throw ConfigError("stream", "the model is a scene of matter; leave it out");
  if (scene.matter == Matter::soft) {
    if (config.brush) validateOnSoft(*config.brush, scene, config.model.mm_per_unit);
    if (!(scene.gain > 0)) throw ConfigError("matter.gain", "is 0; pressing a soft body requires more");
    return;
  }
  if (scene.tool.radius_mm == 0) throw ConfigError("matter.tool.radius_mm", "is 0; the hand requires a ball");
  if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
}

}  // namespace

void validate(const SessionConfig& config) {
  inBoundsOrZero("model.mm_per_unit", config.model.mm_per_unit, bounds::kMinScale, bounds::kMaxScale);
  inBounds("surface.friction", config.surface.friction, 0, bounds::kMaxFriction);
  if (config.surface.radius_mm)
    inBounds("surface.radius_mm", *config.surface.radius_mm, bounds::kShortest_mm, bounds::kLongest_mm);
  validate(config.index);
  validate(config.tool);
  if (config.brush) validate(*config.brush);
  validate(config.force);
  inBounds("undo.undo", static_cast<double>(config.undo.undo), 0, bounds::kMaxCount);
  inBounds("undo.redo", static_cast<double>(config.undo.redo), 0, bounds::kMaxCount);
  inBounds("undo.memory_MiB", config.undo.memory_MiB, bounds::kMinMemory_MiB, bounds::kMaxMemory_MiB);
  if (config.motion) validate(*config.motion);
  checkAbilities(config);
  if (config.stream) validate(*config.stream, config);
  if (config.join) validate(*config.join, config);
  if (config.join && (config.stream || config.matter))
    throw ConfigError("join", "the model is a stream or a scene of matter; leave it out");
  if (config.matter) validate(*config.matter, config);
  for (std::size_t i = 0; i < config.hands.size(); ++i) validate(config.hands[i], i);
  inBoundsOrZero("duration_s", config.duration_s, bounds::kShortest_s, bounds::kLongest_s);
  inBounds("rate_Hz", config.rate_Hz, 1, bounds::kMaxRate_Hz);
}

BrushOptions brushOptions(const BrushConfig& brush, const ModelScale& scale) {
  return {.kind = brush.kind,
          .tau = scale.toUnits(brush.tau_mm),
          .beta = brush.beta,
          .radius = scale.toUnits(brush.radius_mm),
          .strength = brush.strength,
          .falloff = brush.falloff,
          .color = {brush.color[0], brush.color[1], brush.color[2], 255},
          .keepsDensity = brush.keepsDensity};
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
