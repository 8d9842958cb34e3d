// What the touch side reports: its costs, memory and passes.
#include <algorithm>
#include <iterator>

#include "engine/touch/touch_side.hpp"

namespace palpate {

BackendReport TouchSide::report() const {
  return {.machine = device_.name(),
          .cell = 1.0 / static_cast<double>(index_.hash().grid().inverseCell),
          .scope = scope(),
          .build_us = index_.buildTime_us(),
          .editTimes_us = statistics_.editTimes_us,
          .firstEdit_s = statistics_.firstEditTime_s,
          .costs = costs(),
          .bridgeTimes_us = bridge_->answerTimes_us(),
          .shortfalls = statistics_.shortfalls,
          .index = index_.work(),
          .compactions = index_.compactions().completed,
          .isCompacting = index_.isCompacting(),
          .memory = memory()};
}

EditScope TouchSide::scope() const {
  return {.edits = edits_ || frames_.move(),
          .paints = edits_ && (options_.paintable || brushHas(edits_->pass().brush().kind, shared::kPaintsPoints)),
          .newPoints = live().slots() - live().count()};
}

EditCosts TouchSide::costs() const {
  EditCosts costs{.requests_us = statistics_.requestTimes_us,
                  .states = record_.log.published(),
                  .longestCompactionEnd_us = index_.compactions().longestEnd_us};
  if (edits_) costs.lastTouched = edits_->pass().report().changed + edits_->pass().report().gone;
  return costs;
}

BackendMemory TouchSide::memory() const {
  constexpr std::uint64_t kBytesPerSlot = 2 * 2 * sizeof(Vec4);  // positions and normals of both halves
  return {
      .points = kBytesPerSlot * live().slots(), .index = hash().bytes(), .lists = edits_ ? edits_->pass().bytes() : 0};
}

std::vector<PassRecord> TouchSide::passes() const {
  std::vector<PassRecord> all = questions_.passes();
  if (edits_) std::ranges::copy(edits_->passes(), std::back_inserter(all));
  return all;
}

}  // namespace palpate
