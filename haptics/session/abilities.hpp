// The actions that a model allows in a session: one table with one reason for each refusal, which every program quotes.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "engine/core/brush.hpp"
#include "engine/core/touch_capabilities.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct Model;

/// Kind of model that a session touches.
enum class ModelKind {
  cloud,            ///< points at rest, all of them in this program
  moved,            ///< a cloud under a rigid motion
  frames,           ///< a recorded depth camera that plays
  liveFrames,       ///< a live depth camera
  pausedFrames,     ///< the points of a depth camera that was paused
  programFrames,    ///< a cloud that the host program moves
  fluid,            ///< water or sand
  soft,             ///< a soft body
  shared,           ///< a joined cloud that several hands sculpt
  readOnly,         ///< a joined cloud that is served read-only
  partial,          ///< a joined cloud with only the points around the hands in this program
  partialReadOnly,  ///< the same, served read-only
  partialMoving,    ///< the same of a model that moves
};
inline constexpr std::size_t kModelKinds = static_cast<std::size_t>(ModelKind::partialMoving) + 1;  // the last

enum class Action {
  sculpt,
  carve,
  paint,
  insertPoints,
  move,  ///< by a motion
  undo,
  save,
  record,
  select,  ///< set a mask of points: selected, hidden, locked or within
  field,   ///< set numbers of points
  place,   ///< give the model another pose among others
  mirror,  ///< sculpt with symmetry
  layer,   ///< make layers of strokes, and slide their strength
};
inline constexpr std::size_t kActions = static_cast<std::size_t>(Action::layer) + 1;  // the last

/// The action that a brush requires: carve and paint for themselves, Action::sculpt for all others.
Action actionOf(BrushKind kind);

/// The kind of model as far as the configuration tells; a joined cloud counts as sculptable.
ModelKind modelKindOf(const SessionConfig& config);
/// The kind of model of a session. `movedByProgram`: SessionParts::source moves the points.
ModelKind modelKindOf(const SessionConfig& config, const Model& model, bool movedByProgram = false);

/// The table's row of a kind of model, on a back end.
class Abilities {
 public:
  explicit Abilities(ModelKind kind, const TouchCapabilities& can = {}, std::string_view backend = {});

  ModelKind kind() const { return kind_; }
  /// Reason of a refusal, to follow "NAME: "; empty if the action is allowed.
  const std::string& refusal(Action action) const { return refusals_[static_cast<std::size_t>(action)]; }
  bool allow(Action action) const { return refusal(action).empty(); }
  /// Throws UsageError "WHAT: the refusal" if the action is refused.
  void require(Action action, std::string_view what) const;

 private:
  ModelKind kind_;
  std::array<std::string, kActions> refusals_;
};

/// Checks the brush, the motion and the undo of a configuration against its kind of model. Throws ConfigError.
void checkAbilities(const SessionConfig& config);

}  // namespace palpate
