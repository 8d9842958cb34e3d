#include "haptics/session/abilities.hpp"

#include <fmt/format.h>

#include <vector>

#include "haptics/session/model.hpp"

namespace palpate {

namespace {

struct Refusal {
  ModelKind kind;
  Action action;
  std::string_view reason;
};

constexpr std::string_view kMoving = "a moving model cannot be sculpted";
constexpr std::string_view kReadOnly = "the model is served read-only; serve it without --read-only to sculpt it";
constexpr std::string_view kPlaying =
    "the frames of a depth camera cannot be sculpted while they play; pause playback (key K of the window), or fuse "
    "them into a file (palpate convert)";
constexpr std::string_view kOnlyPartial = "only the points around the hand are in this program; join without --partial";
constexpr std::string_view kPlaced = "a joined model cannot be moved";
constexpr std::string_view kRenumbered =
    "each frame of a depth camera has other points, so none can be selected; pause playback (key K of the window)";
constexpr std::string_view kOwnFields =
    "fields are not sent to the server; change them in the program that serves the model";

constexpr std::string_view kOwnLayers =
    "layers of strokes are not sent to the server; make them in the program that serves the model";

// All actions that are not listed are allowed, and some refusals include others (alsoRefused()).
constexpr Refusal kRefusals[] = {
    {ModelKind::moved, Action::sculpt, kMoving},
    {ModelKind::moved, Action::select, "points of a moving model cannot be selected"},
    {ModelKind::moved, Action::place, "a moving model cannot be placed"},
    {ModelKind::frames, Action::sculpt, kPlaying},
    {ModelKind::frames, Action::select, kRenumbered},
    {ModelKind::frames, Action::move, "the frames of a depth camera move already"},
    {ModelKind::liveFrames, Action::sculpt, kPlaying},
    {ModelKind::liveFrames, Action::select, kRenumbered},
    {ModelKind::liveFrames, Action::move, "the frames of a depth camera move already"},
    {ModelKind::liveFrames, Action::record, "live frames cannot be played again, so the session cannot be recorded"},
    {ModelKind::pausedFrames, Action::record, "paused frames are in no file yet; save the points and open that file"},
    {ModelKind::programFrames, Action::sculpt, "frames from the host program cannot be sculpted"},
    {ModelKind::programFrames, Action::record, "frames from the host program cannot be recorded"},
    {ModelKind::programFrames, Action::select, "points of frames from the host program cannot be selected"},
    {ModelKind::programFrames, Action::place, "the host program places the points of its frames"},
    {ModelKind::fluid, Action::sculpt, "water and sand cannot be sculpted; the hand moves them"},
    {ModelKind::fluid, Action::move, "a simulated scene moves already"},
    {ModelKind::fluid, Action::select, "particles of water and sand cannot be selected"},
    {ModelKind::soft, Action::carve, "a soft body cannot be carved, because it keeps its cells; use push"},
    {ModelKind::soft, Action::paint, "a soft body cannot be painted; paint its model first"},
    {ModelKind::soft, Action::move, "a simulated scene moves already"},
    {ModelKind::soft, Action::select, "points of a soft body cannot be selected"},
    {ModelKind::soft, Action::mirror, "a soft body moves, so that no plane of symmetry stays in its middle"},
    {ModelKind::shared, Action::insertPoints, "points cannot be inserted where several hands sculpt"},
    {ModelKind::shared, Action::move, kPlaced},
    {ModelKind::shared, Action::field, kOwnFields},
    {ModelKind::shared, Action::layer, kOwnLayers},
    {ModelKind::shared, Action::record, "the strokes of others cannot be recorded; serve the model with --read-only"},
    {ModelKind::readOnly, Action::sculpt, kReadOnly},
    {ModelKind::readOnly, Action::move, kPlaced},
    {ModelKind::readOnly, Action::field, kOwnFields},
    {ModelKind::partial, Action::insertPoints, "points cannot be inserted where several hands sculpt"},
    {ModelKind::partial, Action::mirror, kOnlyPartial},
    {ModelKind::partial, Action::move, kPlaced},
    {ModelKind::partial, Action::record, kOnlyPartial},
    {ModelKind::partial, Action::select, kOnlyPartial},
    {ModelKind::partialReadOnly, Action::sculpt, kReadOnly},
    {ModelKind::partialReadOnly, Action::move, kPlaced},
    {ModelKind::partialReadOnly, Action::record, kOnlyPartial},
    {ModelKind::partialReadOnly, Action::select, kOnlyPartial},
    {ModelKind::partialMoving, Action::sculpt, kMoving},
    {ModelKind::partialMoving, Action::move, kPlaced},
    {ModelKind::partialMoving, Action::undo, kMoving},
    {ModelKind::partialMoving, Action::save, "a moving model that was joined cannot be saved"},
    {ModelKind::partialMoving, Action::record, kOnlyPartial},
    {ModelKind::partialMoving, Action::select, kOnlyPartial},
};

// What a model that refuses the action refuses for the same reason.
std::vector<Action> alsoRefused(Action action) {
  if (action == Action::sculpt)
    return {Action::carve, Action::paint, Action::insertPoints, Action::mirror, Action::layer};
  if (action == Action::move) return {Action::place};
  if (action == Action::select) return {Action::field, Action::layer};
  return {};
}

}  // namespace

Action actionOf(BrushKind kind) {
  if (brushHas(kind, shared::kRemovesPoints)) return Action::carve;
  return brushHas(kind, shared::kMovesPoints) ? Action::sculpt : Action::paint;
}

ModelKind modelKindOf(const SessionConfig& config) {
  if (config.model.matter) return config.model.matter->isSoft() ? ModelKind::soft : ModelKind::fluid;
  if (config.model.stream) return config.model.stream->live ? ModelKind::liveFrames : ModelKind::frames;
  if (config.model.join) return config.model.join->partial ? ModelKind::partial : ModelKind::shared;
  return config.motion ? ModelKind::moved : ModelKind::cloud;
}

ModelKind modelKindOf(const SessionConfig& config, const Model& model, bool movedByProgram) {
  if (movedByProgram) return ModelKind::programFrames;
  if (model.far() && model.far()->moves()) return ModelKind::partialMoving;
  if (model.far()) return model.far()->isSculptable() ? ModelKind::partial : ModelKind::partialReadOnly;
  if (config.model.join) return model.share() ? ModelKind::shared : ModelKind::readOnly;
  if (model.stream() && !config.model.stream) return ModelKind::pausedFrames;
  return modelKindOf(config);
}

Abilities::Abilities(ModelKind kind, const TouchCapabilities& can, std::string_view backend) : kind_(kind) {
  const auto refuse = [&](Action action, std::string_view reason) {
    std::string& said = refusals_[static_cast<std::size_t>(action)];
    if (said.empty()) said = reason;
  };
  for (const Refusal& row : kRefusals) {
    if (row.kind != kind) continue;
    refuse(row.action, row.reason);
    for (const Action other : alsoRefused(row.action)) refuse(other, row.reason);
  }
  if (can.keepsEdits) return;
  const std::string deaf = fmt::format("back end {} does not report its edits; use vulkan or cpu", backend);
  for (const Action action : {Action::undo, Action::record, Action::select, Action::field, Action::layer})
    refuse(action, deaf);
}

void Abilities::require(Action action, std::string_view what) const {
  if (!allow(action)) throw UsageError("{}: {}", what, refusal(action));
}

void checkAbilities(const SessionConfig& config) {
  const Abilities can(modelKindOf(config));
  const auto require = [&](Action action, std::string_view field) {
    if (!can.allow(action)) throw ConfigError(field, "{}", can.refusal(action));
  };
  if (config.motion) require(Action::move, "motion.kind");
  if (config.brush) require(actionOf(config.brush->kind), "brush.kind");
  if (config.brush && config.brush->resample) require(Action::insertPoints, "brush.resample");
  if (config.brush && !config.brush->symmetry.empty()) require(Action::mirror, "brush.symmetry");
  if (config.undo.undo > 0) require(Action::undo, "undo.undo");
}

}  // namespace palpate
