#include "apps/view/session.hpp"

#include <utility>

#include "engine/core/named_values.hpp"
#include "haptics/devices/guided_touch.hpp"

namespace palpate {

namespace {

// In a shared session no points are added or removed.
std::optional<BrushConfig> brushOf(const BrushSettings& brush, const SessionConfig& config) {
  if (!brush.sculpts) return std::nullopt;
  BrushConfig used = brush;
  used.resample = !config.model.join;
  return used;
}

SurfaceConfig surfaceOf(SurfaceConfig surface, const FeelSettings& feel) {
  surface.kind = feel.surface;
  surface.friction = feel.friction;
  return surface;
}

ForceOptions forceOf(const FeelSettings& feel) {
  return {.stiffness_N_per_mm = feel.stiffness_N_per_mm,
          .damping_N_s_per_mm = feel.damping_N_s_per_mm,
          .maxForce_N = feel.maxForce_N,
          .handGain = feel.handGain};
}

// Only a GPU has more than one method.
std::string methodOf(const std::string& backend, const FeelSettings& feel) {
  return backend == "vulkan" ? std::string(nameOf(kQueryMethods, feel.method)) : std::string();
}

SessionConfig configOf(const WindowOptions& options, const BrushSettings& brush, const FeelSettings& feel) {
  SessionConfig config = options.config;
  // A model that refuses the brush is felt without it; setBrushSettings() gives the reason.
  if (brush.sculpts && Abilities(modelKindOf(config)).allow(actionOf(brush.kind)))
    config.brush = brushOf(brush, config);
  config.surface = surfaceOf(config.surface, feel);
  config.force = forceOf(feel);
  config.backend.method = methodOf(config.backend.name, feel);
  return config;
}

}  // namespace

WindowSession::WindowSession(Context& context, Device& sight, Model model, const WindowOptions& options,
                             const BrushSettings& brush, const FeelSettings& feel)
    : InteractiveSession(configOf(options, brush, feel), std::move(model),
                         {.backend = context.backends().named(options.config.backend.name),
                          .threads = context.threads(),
                          .undo = options.undo,
                          .followers = {[this, &sight](const Model& touched, TouchBackend& backend) {
                            auto drawn = std::make_unique<DrawnFollower>(sight, touched, backend);
                            follower = drawn.get();
                            return drawn;
                          }}},
                         options.live),
      brush_(brush),
      feel_(feel) {}

DrawnCloud& WindowSession::drawn() {
  session().checkFollower();
  return follower->drawn();
}

HeldTool WindowSession::heldTool() const {
  HeldTool tool{.ballRadius = model().ballRadius()};
  if (const auto brush = brushOf(brush_, config()); brush && (config().brush || !config().model.matter))
    tool.brush = brushOptions(*brush, model().scale);
  return tool;
}

double WindowSession::givenWay_mm() const {
  if (!brush_.sculpts || !brushHas(brush_.kind, shared::kHasShaft | shared::kRaisesSurface)) return 0;
  return brush_.yieldDepth_mm * (1 + feel_.stiffness_N_per_mm / guidedHand(DVec3(1)).handStiffness_N_per_mm);
}

void WindowSession::setBrushSettings(const BrushSettings& brush) {
  if (brush == brush_ || !isTouching()) return;
  brush_ = brush;
  const Abilities can(modelKindOf(config()));
  if (brush.sculpts && config().model.stream && holdsFrames()) return;  // another session sculpts a paused frame
  if (!brush.sculpts || can.allow(actionOf(brush.kind))) return setBrush(brushOf(brush, config()));
  if (can.allow(Action::sculpt)) setBrush(std::nullopt);
  throw Error("{}", can.refusal(actionOf(brush.kind)));
}

void WindowSession::setFeel(const FeelSettings& feel) {
  if (feel == feel_ || !isTouching()) return;
  feel_ = feel;
  setContact(surfaceOf(config().surface, feel), forceOf(feel), methodOf(backendName(), feel));
}

}  // namespace palpate
