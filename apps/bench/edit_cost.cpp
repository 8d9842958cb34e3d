#include "apps/bench/edit_cost.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "apps/bench/bench.hpp"

namespace palpate {

namespace {

std::string times(const Summary& s) {
  if (s.count == 0) return "–";
  const int decimals = s.p999 < 1e4 ? 1 : 0;
  return fmt::format("{:.{}f} / {:.{}f}", s.p50, decimals, s.p999, decimals);
}

struct EditColumn {
  const char* title;
  int width;
  std::function<std::string(const EditCost&)> text;
};

void print(std::FILE* out, const std::string& title, const std::vector<EditColumn>& columns,
           const std::vector<EditCost>& costs) {
  fmt::print(out, "\n{}\n", title);
  for (const EditColumn& column : columns) fmt::print(out, "{:>{}}", column.title, column.width);
  fmt::print(out, "\n");
  for (const EditCost& cost : costs) {
    for (const EditColumn& column : columns) fmt::print(out, "{:>{}}", column.text(cost), column.width);
    fmt::print(out, "\n");
  }
}

std::vector<EditColumn> commonColumns() {
  return {{"model", 18, [](const EditCost& c) { return c.subject; }},
          {"back end", 10, [](const EditCost& c) { return c.backend; }},
          {"points", 11, [](const EditCost& c) { return fmt::format("{}", c.points); }},
          {"asked", 8, [](const EditCost& c) { return fmt::format("{}", c.asked); }},
          {"touched", 9, [](const EditCost& c) { return fmt::format("{:.0f}", c.touched.p50); }},
          {"index", 13, [](const EditCost& c) { return c.index; }}};
}

std::vector<EditColumn> with(std::vector<EditColumn> columns, std::initializer_list<EditColumn> more) {
  columns.insert(columns.end(), more);
  return columns;
}

// The costs measured in virtual time, or those in real time.
std::vector<EditCost> only(const std::vector<EditCost>& costs, bool realtime) {
  std::vector<EditCost> chosen;
  std::ranges::copy_if(costs, std::back_inserter(chosen),
                       [&](const EditCost& cost) { return cost.stroke.has_value() == realtime; });
  return chosen;
}

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

void printEditTables(std::FILE* out, const std::vector<EditCost>& costs) {
  const auto paced = only(costs, false), realtime = only(costs, true);
  if (!paced.empty()) {
    print(out, fmt::format("edited step, {}; us, median / p99.9", paced.front().brush),
          with(commonColumns(),
               {{"query", 19, [](const EditCost& c) { return times(c.query_us); }},
                {"edit", 19, [](const EditCost& c) { return times(c.edit_us); }},
                {"both", 19, [](const EditCost& c) { return times(c.indexed_us); }},
                {"then requests", 19, [](const EditCost& c) { return times(c.requests_us); }},
                {"step, in all", 19, [](const EditCost& c) { return times(c.step_us); }},
                {"edits", 7, [](const EditCost& c) { return fmt::format("{}", c.edits); }},
                {"builds", 8, [](const EditCost& c) { return fmt::format("{}", c.builds); }},
                {"compactions", 13, [](const EditCost& c) { return fmt::format("{}", c.compactions); }},
                {"step that compacts", 21, [](const EditCost& c) { return times(c.compactingStep_us); }},
                {"index MiB", 11,
                 [](const EditCost& c) {
                   return fmt::format("{:.1f}", static_cast<double>(c.memory.ofIndex()) / (1 << 20));
                 }},
                {"/ plain", 9, [](const EditCost& c) { return fmt::format("{:.2f}", c.memory.overPlain()); }}}),
          paced);
    for (const EditGrowth& growth : growths(paced))
      fmt::print(out, "{}, {}, edits of {} points: a step on {} points takes {:.2f} times one on {}\n", growth.backend,
                 growth.index, growth.asked, growth.to, growth.factor, growth.from);
    for (const EditCrossover& crossover : crossovers(paced))
      fmt::print(out, "{}, {}, {} points: a full build is cheaper from {}{:.2g} of the points on\n", crossover.backend,
                 crossover.subject, crossover.points, crossover.found ? "" : "more than ", crossover.share);
  }
  if (realtime.empty()) return;
  const EditStroke& stroke = *realtime.front().stroke;
  print(out,
        fmt::format("pose to force while sculpting, {}; {:g} s at {:g} Hz; us, median / p99.9", realtime.front().brush,
                    stroke.duration_s, stroke.rate_Hz),
        with(commonColumns(),
             {{"step", 19, [](const EditCost& c) { return times(c.step_us); }},
              {"p99", 9, [](const EditCost& c) { return fmt::format("{:.0f}", c.step_us.p99); }},
              {"edit", 19, [](const EditCost& c) { return times(c.edit_us); }},
              {"then requests", 19, [](const EditCost& c) { return times(c.requests_us); }},
              {"edits/s", 9, [](const EditCost& c) { return fmt::format("{:.0f}", c.stroke->editsPerSecond); }},
              {"fresh", 8, [](const EditCost& c) { return fmt::format("{:.1f} %", 100 * c.stroke->freshShare); }},
              {"left out", 10, [](const EditCost& c) { return fmt::format("{}", c.stroke->leftOut); }},
              {"held up", 9, [](const EditCost& c) { return fmt::format("{}", c.stroke->heldUp); }},
              {"missed", 8, [](const EditCost& c) { return fmt::format("{}", c.stroke->missedTicks); }},
              {"builds", 8, [](const EditCost& c) { return fmt::format("{}", c.builds); }},
              {"compactions", 13, [](const EditCost& c) { return fmt::format("{}", c.compactions); }},
              {"step meanwhile", 19, [](const EditCost& c) { return times(c.compactingStep_us); }},
              {"longest end", 13,
               [](const EditCost& c) {
                 return c.compactions ? fmt::format("{:.1f}", c.longestCompactionEnd_us) : std::string("–");
               }}}),
        realtime);
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
