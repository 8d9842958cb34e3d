#include "apps/cli/mask_options.hpp"

#include <algorithm>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/select/expression.hpp"
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
    command.add(mask.name, masks[static_cast<std::size_t>(mask.role)], mask.help).typeName("CONDITION");
}

void checkMaskOptions(const MaskConditions& masks, bool hasBrush) {
  for (const MaskOption& mask : kMasks)
    if (!hasBrush && !masks[static_cast<std::size_t>(mask.role)].empty())
      throw UsageError("{}: requires a brush (--edit); to leave points out without one, use --where", mask.name);
}

void setMasks(Context& context, const MaskConditions& masks, Session& session) {
  if (std::ranges::all_of(masks, &std::string::empty)) return;
  const Model& model = session.model();
  CloudFields fields(model.cloud, {.mm_per_unit = model.scale.mm_per_unit, .threads = context.threads()});
  for (const MaskOption& mask : kMasks) {
    const std::string& condition = masks[static_cast<std::size_t>(mask.role)];
    if (condition.empty()) continue;
    const PointSet points = pointsWhere(mask.name, condition, fields);
    if (points.empty()) throw Error("{}: '{}' holds for no point", mask.name, condition);
    session.setMask(mask.role, points);
    context.log().say("{} of {} {}", points.count(), counted(model.cloud.size(), "point"), mask.remark);
  }
}

}  // namespace palpate
