#include "apps/cli/mask_options.hpp"

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/surface_select.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

namespace {

struct MaskOption {
  const char* name;
  MaskRole role;
  const char *help, *remark;
};
constexpr MaskOption kMasks[]{
    {"--hide", MaskRole::hidden, "the points for which it holds, as in --where, cannot be felt; they are saved",
     "hidden"},
    {"--lock", MaskRole::locked, "the points for which it holds are felt, and no brush changes them", "locked"},
    {"--only", MaskRole::within, "brushes change only the points for which it holds", "may be changed"}};

}  // namespace

void addMaskOptions(Options& command, MaskConditions& masks) {
  for (const MaskOption& mask : kMasks)
    command.add(mask.name, masks.where[static_cast<std::size_t>(mask.role)], mask.help).typeName("CONDITION");
  command
      .add("--lock-rim", masks.lockRim_mm,
           "width in the hand of a soft rim around the points of --lock: brushes change its points the less the nearer "
           "they are to these")
      .check(between(0, 1e4))
      .unit("mm");
}

void checkMaskOptions(const MaskConditions& masks, bool hasBrush) {
  for (const MaskOption& mask : kMasks)
    if (!hasBrush && !masks.where[static_cast<std::size_t>(mask.role)].empty())
      throw UsageError("{}: requires a brush (--edit); to leave points out without one, use --where", mask.name);
  if (masks.lockRim_mm > 0 && masks.where[static_cast<std::size_t>(MaskRole::locked)].empty())
    throw UsageError("--lock-rim: requires --lock, around whose points the rim is");
}

void setMasks(Context& context, const MaskConditions& masks, Session& session) {
  const Model& model = session.model();
  if (const std::size_t locked = session.config().brush ? session.lockedByFile() : 0; locked > 0)
    context.log().say("{} of {} locked, also in part, by the field {} of the file", locked,
                      counted(model.cloud.size(), "point"), kLockField);
  if (masks.empty()) return;
  CloudFields fields(model.cloud, {.mm_per_unit = model.scale.mm_per_unit, .threads = context.threads()});
  for (const MaskOption& mask : kMasks) {
    const std::string& condition = masks.where[static_cast<std::size_t>(mask.role)];
    if (condition.empty()) continue;
    const PointSet points = pointsWhere(mask.name, condition, fields);
    if (points.empty()) throw Error("{}: '{}' holds for no point", mask.name, condition);
    if (mask.role == MaskRole::locked && masks.lockRim_mm > 0) {
      const std::span<const PointState> states = session.history()->points();
      session.setLockWeights(withRim(states, shownPoints(states, {}), PointBits(points, states.size()),
                                     model.scale.toUnits(masks.lockRim_mm), context.threads()));
    } else {
      session.setMask(mask.role, points);
    }
    context.log().say("{} of {} {}", points.count(), counted(model.cloud.size(), "point"), mask.remark);
  }
}

}  // namespace palpate
