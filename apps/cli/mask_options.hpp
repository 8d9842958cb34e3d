// Options that hide, lock or leave alone the points for which a condition holds.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "apps/cli/context.hpp"
#include "engine/core/attribute_change.hpp"

namespace palpate {

class Session;

/// Conditions for the points of each mask; empty: none.
struct MaskConditions {
  std::array<std::string, kMaskRoles> where;
  double lockRim_mm = 0;  ///< width of the soft rim around the locked points

  bool empty() const { return std::ranges::all_of(where, &std::string::empty); }
};

void addMaskOptions(Options& command, MaskConditions& masks);
/// Throws UsageError for masks of a session in which no point can change.
void checkMaskOptions(const MaskConditions& masks, bool hasBrush);
/// Sets the masks by the points as they were loaded, and says how many points they have. Throws ExpressionError, and
/// Error for a condition that holds for no point.
void setMasks(Context& context, const MaskConditions& masks, Session& session);

}  // namespace palpate
