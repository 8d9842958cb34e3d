#include "apps/bench/edit_cost.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "apps/bench/bench.hpp"

namespace palpate {

namespace {

// At most one in this many updates may have needed a build: their median is still that of updates.
constexpr std::uint64_t kUpdatesPerBuild = 10;

// Share of the points touched, time with an update, time with a build.
struct Duel {
  double share, update_us, build_us;
  double logRatio() const { return std::log(update_us / build_us); }
};

// On the model and back end of `like`.
std::vector<Duel> duels(const std::vector<EditCost>& costs, const EditCost& like) {
  const auto isAlike = [&](const EditCost& cost) {
    return cost.subject == like.subject && cost.backend == like.backend && cost.points == like.points;
  };
  std::vector<Duel> all;
  for (const EditCost& update : costs)
    for (const EditCost& build : costs)
      if (isAlike(update) && isAlike(build) && update.asked == build.asked && update.index == "incremental" &&
          build.index == "rebuild" && kUpdatesPerBuild * update.builds <= update.edits && update.edit_us.count > 0 &&
          build.edit_us.count > 0)
        all.push_back({update.touched.p50 / static_cast<double>(like.points), update.edit_us.p50, build.edit_us.p50});
  std::ranges::sort(all, {}, &Duel::share);
  return all;
}

}  // namespace

std::vector<EditCrossover> crossovers(const std::vector<EditCost>& costs) {
  std::map<std::tuple<std::string, std::size_t, std::string>, EditCrossover> byModel;
  for (const EditCost& cost : costs) {
    const std::vector<Duel> all = duels(costs, cost);
    if (all.empty()) continue;
    EditCrossover& result = byModel[{cost.backend, cost.points, cost.subject}];
    result = {.subject = cost.subject, .backend = cost.backend, .points = cost.points, .share = all.back().share};
    for (std::size_t i = 0; i < all.size() && !result.found; ++i) {
      if (all[i].logRatio() < 0) continue;
      result.found = true;
      result.share = all[i].share;
      if (i == 0) continue;  // more expensive from the smallest edit on
      // Between two measurements both times are nearly powers of the fraction.
      const double before = all[i - 1].logRatio(), at = before / (before - all[i].logRatio());
      result.share = all[i - 1].share * std::pow(all[i].share / all[i - 1].share, at);
    }
  }
  std::vector<EditCrossover> results;
  results.reserve(byModel.size());
  for (const auto& [model, crossover] : byModel) results.push_back(crossover);
  return results;
}

std::vector<EditGrowth> growths(const std::vector<EditCost>& costs) {
  std::map<std::tuple<std::string, std::size_t, std::string>, std::pair<const EditCost*, const EditCost*>> ends;
  for (const EditCost& cost : costs) {
    auto& [least, most] = ends[{cost.backend, cost.asked, cost.index}];
    if (!least || cost.points < least->points) least = &cost;
    if (!most || cost.points > most->points) most = &cost;
  }
  std::vector<EditGrowth> results;
  for (const auto& [key, end] : ends)
    if (end.first->points < end.second->points && end.first->step_us.p50 > 0)
      results.push_back({.backend = std::get<0>(key),
                         .index = std::get<2>(key),
                         .asked = std::get<1>(key),
                         .from = end.first->points,
                         .to = end.second->points,
                         .factor = end.second->step_us.p50 / end.first->step_us.p50});
  return results;
}

namespace {

using Value = std::optional<Json>;

constexpr Reported<EditStroke> kRealtimeStroke[]{
    {"rate_Hz", "Hz", "ticks per second", field<&EditStroke::rate_Hz>},
    {"duration_s", "s", "duration", field<&EditStroke::duration_s>},
    {"fresh_fraction", "1", "fraction of ticks answered in time", field<&EditStroke::freshShare>},
    {"edits_per_s", "1/s", "edits per second", field<&EditStroke::editsPerSecond>},
    {"missed_ticks", "", "ticks skipped because their time had passed", field<&EditStroke::missedTicks>},
    {"dropped_edits", "", "edits dropped for lack of time, or because the edit log was full",
     field<&EditStroke::leftOut>},
    {"held_up_edits", "", "edits that waited for a compaction", field<&EditStroke::heldUp>},
};

constexpr Reported<EditCost> kEditCosts[]{
    {"subject", "", "model", field<&EditCost::subject>},
    {"backend", "", "back end", field<&EditCost::backend>},
    {"points", "", "points of the model", field<&EditCost::points>},
    {"brush", "", "brush", field<&EditCost::brush>},
    {"symmetry", "", "where edits are mirrored; empty: nowhere", field<&EditCost::symmetry>},
    {"index", "", "how the index follows edits: incremental or rebuild", field<&EditCost::index>},
    {"asked", "", "points that an edit should touch", field<&EditCost::asked>},
    {"brush_radius_mm", "mm", "radius of the brush", field<&EditCost::brushRadius_mm>},
    {"spacing_mm", "mm", "mean distance of neighbouring points", field<&EditCost::spacing_mm>},
    {"touched", "", "points that an edit moved, changed or removed", quantiles<&EditCost::touched>},
    {"query_us", "us", "query on the GPU, in ticks with an edit; null: not measured", quantiles<&EditCost::query_us>},
    {"edit_us", "us", "brush, index, normals and edit log on the answering machine", quantiles<&EditCost::edit_us>},
    {"query_and_edit_us", "us", "in virtual time: query and edit of a tick together, on the GPU; else null",
     quantiles<&EditCost::indexed_us>},
    {"requests_us", "us", "after the edit: where the next one should insert and remove points",
     quantiles<&EditCost::requests_us>},
    {"step_us", "us", "time from pose to force; in virtual time including the whole edit",
     quantiles<&EditCost::step_us>},
    {"edits", "", "measured edits", field<&EditCost::edits>},
    {"index_rebuilds", "", "rebuilds of the index for these edits", field<&EditCost::builds>},
    {"compactions", "", "compactions of the index in the background", field<&EditCost::compactions>},
    {"compacting_step_us", "us", "step_us during a compaction; null: none", quantiles<&EditCost::compactingStep_us>},
    {"longest_compaction_end_us", "us", "longest wait of touch for the end of a compaction",
     field<&EditCost::longestCompactionEnd_us>},
    {"landings", "", "times that the brush was lowered onto the surface", field<&EditCost::landings>},
    {"memory.points_bytes", "B", "memory of the points",
     [](const EditCost& c) -> Value { return c.memory.edited.points; }},
    {"memory.index_bytes", "B", "memory of the index",
     [](const EditCost& c) -> Value { return c.memory.edited.index; }},
    {"memory.lists_bytes", "B", "memory of the lists of an edit",
     [](const EditCost& c) -> Value { return c.memory.edited.lists; }},
    {"memory.plain_bytes", "B", "points and index of the same cloud where nothing is edited",
     [](const EditCost& c) -> Value { return c.memory.plain; }},
    {"memory.over_plain", "1", "memory of points, index and lists relative to plain_bytes",
     [](const EditCost& c) -> Value { return c.memory.overPlain(); }},
    {"stroke", "", "a stroke in real time (--duration)",
     [](const EditCost& c) -> Value { return partBy(kRealtimeStroke, c.stroke); }},
};

constexpr Reported<EditCrossover> kCrossovers[]{
    {"subject", "", "model", field<&EditCrossover::subject>},
    {"backend", "", "back end", field<&EditCrossover::backend>},
    {"points", "", "points of the model", field<&EditCrossover::points>},
    {"share", "1", "fraction of touched points above which a rebuild of the index is cheaper",
     field<&EditCrossover::share>},
    {"found", "", "false: the fraction is the largest one measured, and the update was still cheaper",
     field<&EditCrossover::found>},
};

constexpr Reported<EditGrowth> kGrowths[]{
    {"backend", "", "back end", field<&EditGrowth::backend>},
    {"index", "", "how the index follows edits", field<&EditGrowth::index>},
    {"asked", "", "points that an edit should touch", field<&EditGrowth::asked>},
    {"from_points", "", "points of the smallest model", field<&EditGrowth::from>},
    {"to_points", "", "points of the largest model", field<&EditGrowth::to>},
    {"factor", "1", "ratio of their median steps", field<&EditGrowth::factor>},
};

constexpr Reported<std::vector<EditCost>> kEditBench[]{
    {"costs", "", "one for each model, number of touched points, back end and index",
     [](const std::vector<EditCost>& costs) -> Value { return arrayBy(kEditCosts, costs); }},
    {"growths", "", "how the cost grows with the points of the model",
     [](const std::vector<EditCost>& costs) -> Value { return arrayBy(kGrowths, growths(costs)); }},
    {"crossovers", "", "sizes of an edit above which a rebuild of the index is cheaper",
     [](const std::vector<EditCost>& costs) -> Value { return arrayBy(kCrossovers, crossovers(costs)); }},
};

}  // namespace

Json toJson(const std::vector<EditCost>& costs) { return jsonBy(kEditBench, costs); }

void listEditBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "edit", ".", kEditBench);
  listAlone(all, "edit", ".costs[].", kEditCosts);
  listAlone(all, "edit", ".costs[].stroke.", kRealtimeStroke);
  listAlone(all, "edit", ".growths[].", kGrowths);
  listAlone(all, "edit", ".crossovers[].", kCrossovers);
}

}  // namespace palpate
