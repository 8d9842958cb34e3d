// What can be done with a set of points, as one stroke.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"
#include "engine/edit/point_states.hpp"

namespace palpate {

struct RemovePoints {};
struct PaintPoints {
  std::uint32_t color = 0;  ///< packedColor()
};
/// To `offset` + `scale` * (`rotation` * position), of positions relative to the cloud's origin; normals rotate.
struct MovePoints {
  DQuat rotation{1, 0, 0, 0};  ///< unit
  double scale = 1;            ///< positive
  DVec3 offset{0};             ///< model units

  /// Rotates and scales about `centre`, which then moves by `way`.
  static MovePoints about(const DVec3& centre, const DQuat& rotation, double scale, const DVec3& way) {
    return {rotation, scale, centre + way - scale * (rotation * centre)};
  }
  DVec3 operator()(const DVec3& position) const { return offset + scale * (rotation * position); }
};
/// To these states, each of another point: existing ones, and new ones, whose numbers follow those of all points in
/// order.
struct SetPoints {
  std::vector<PointState> states;
};
using PointsAction = std::variant<RemovePoints, PaintPoints, MovePoints, SetPoints>;

/// The state of an existing point after the action; of SetPoints that before.
PointState stateAfter(const PointState& state, const PointsAction& action);
/// Those of the existing points of the set that it changes, ascending.
BareVector<PointState> statesAfter(const PointSet& points, const PointStates& present, const PointsAction& action);
/// Throws UsageError for a rotation that is not unit, a scale that is not positive, and numbers that are not finite; of
/// SetPoints nothing.
void validate(const PointsAction& action);

/// To bytes for a log, and back; nothing if they are not those of an action. The set is of no meaning for SetPoints.
std::string bytesIn(const PointsAction& action, const PointSet& points);
std::optional<std::pair<PointsAction, PointSet>> readPointsAction(std::string_view bytes);

}  // namespace palpate
