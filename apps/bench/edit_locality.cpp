#include "apps/bench/edit_locality.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/bench/bench.hpp"

namespace palpate {

namespace {

constexpr std::string_view kRow =
    "{:<20}{:>8} {:<8}{:<8}{:<6}{:>7}{:>7}{:>7}{:>11}{:>9}{:>9}{:>13}{:>8}{:>12}{:>7}{:>10}{:>7}{:>6}{:>8}  {}\n";

double share(std::size_t part, std::size_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

}  // namespace

std::vector<std::string_view> StrokeRecord::broken(bool strict) const {
  std::vector<std::string_view> broken = verdict.broken(carves, strict);
  if (before.changed()) broken.emplace_back("look changes");
  if (!settled) broken.emplace_back("never settles");
  if (after.changed()) broken.emplace_back("settled look changes");
  return broken;
}

namespace {

using Value = std::optional<Json>;

constexpr Reported<IdleRecord> kLook[]{
    {"ticks", "", "ticks in which the brush acted", field<&IdleRecord::ticks>},
    {"moved", "", "points moved", field<&IdleRecord::moved>},
    {"inserted", "", "points inserted", field<&IdleRecord::inserted>},
    {"removed", "", "points removed", field<&IdleRecord::removed>},
};

constexpr Reported<StrokeRecord> kStrokes[]{
    {"subject", "", "model", field<&StrokeRecord::subject>},
    {"points", "", "its points", field<&StrokeRecord::points>},
    {"backend", "", "back end", field<&StrokeRecord::backend>},
    {"brush", "", "brush", field<&StrokeRecord::brush>},
    {"gesture", "", "press or slide", field<&StrokeRecord::gesture>},
    {"spacing_mm", "mm", "mean distance of neighbouring points", field<&StrokeRecord::spacing_mm>},
    {"radius_mm", "mm", "support radius", field<&StrokeRecord::radius_mm>},
    {"brush_radius_mm", "mm", "radius of the brush", field<&StrokeRecord::brushRadius_mm>},
    {"ticks", "", "ticks of the stroke", field<&StrokeRecord::ticks>},
    {"acting_ticks", "", "ticks in which the brush acted", field<&StrokeRecord::acting>},
    {"moved", "", "points moved", [](const StrokeRecord& r) -> Value { return r.verdict.moved; }},
    {"painted", "", "points painted", [](const StrokeRecord& r) -> Value { return r.verdict.painted; }},
    {"inserted", "", "points inserted", [](const StrokeRecord& r) -> Value { return r.verdict.inserted; }},
    {"removed", "", "points removed", [](const StrokeRecord& r) -> Value { return r.verdict.removed; }},
    {"farthest_moved_R", "support radii", "largest distance of moved points beyond the brush's radius from its path",
     [](const StrokeRecord& r) -> Value { return r.verdict.farthestMoved; }},
    {"farthest_inserted_R", "support radii", "the same of inserted points",
     [](const StrokeRecord& r) -> Value { return r.verdict.farthestInserted; }},
    {"crowded_share", "1", "fraction of the inserted points closer than 0.4 spacings to a neighbour",
     [](const StrokeRecord& r) -> Value { return share(r.verdict.crowded, r.verdict.inserted); }},
    {"nearest_spacings", "spacings", "smallest distance of an inserted point from a neighbour",
     [](const StrokeRecord& r) -> Value { return r.verdict.nearest; }},
    {"outside", "", "inserted points off the old surface",
     [](const StrokeRecord& r) -> Value { return r.verdict.outside; }},
    {"farthest_outside_R", "support radii", "how far they are off it at most",
     [](const StrokeRecord& r) -> Value { return r.verdict.farthestOutside; }},
    {"deepest_mm", "mm", "largest distance of changed points under the old surface", field<&StrokeRecord::deepest_mm>},
    {"highest_mm", "mm", "the same over it", field<&StrokeRecord::highest_mm>},
    {"doubled_share", "1", "fraction of the changed points with one that faces the other way within half a spacing",
     [](const StrokeRecord& r) -> Value { return share(r.verdict.doubled, r.verdict.changed); }},
    {"normals.fitted", "", "changed points whose normal was compared with a plane fit",
     [](const StrokeRecord& r) -> Value { return r.verdict.fitted; }},
    {"normals.p95_deg", "deg", "95th percentile of the angle between them",
     [](const StrokeRecord& r) -> Value { return r.verdict.normal_deg; }},
    {"normals.sided", "", "changed points whose side is known",
     [](const StrokeRecord& r) -> Value { return r.verdict.sided; }},
    {"normals.turned", "", "of these, with a normal that faces the wrong way",
     [](const StrokeRecord& r) -> Value { return r.verdict.turned; }},
    {"turned_at_rest", "", "points at rest with a normal that faces the wrong way",
     [](const StrokeRecord& r) -> Value { return r.verdict.turnedAtRest; }},
    {"settling_ticks", "", "ticks in the air until the last change", field<&StrokeRecord::settling>},
    {"settled", "", "false: it still changed at the last tick observed", field<&StrokeRecord::settled>},
    {"look_before", "", "changes by a brush without effect before the stroke",
     [](const StrokeRecord& r) -> Value { return jsonBy(kLook, r.before); }},
    {"look_after", "", "the same after it", [](const StrokeRecord& r) -> Value { return jsonBy(kLook, r.after); }},
    {"broken", "", "broken promises, in words", [](const StrokeRecord& r) -> Value { return r.broken(); }},
    {"strictly_broken", "", "the same without any tolerance",
     [](const StrokeRecord& r) -> Value { return r.broken(true); }},
};

constexpr Reported<LocalityResults> kLocality[]{
    {"strokes", "", "one for each stroke",
     [](const LocalityResults& r) -> Value { return arrayBy(kStrokes, r.strokes); }},
    {"broken", "", "strokes that broke a promise of edits",
     [](const LocalityResults& r) -> Value { return r.broken(); }},
    {"strictly_broken", "", "the same without any tolerance",
     [](const LocalityResults& r) -> Value { return r.broken(true); }},
};

}  // namespace

std::size_t LocalityResults::broken(bool strict) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(strokes, [&](const StrokeRecord& stroke) { return !stroke.broken(strict).empty(); }));
}

Json toJson(const LocalityResults& results) { return jsonBy(kLocality, results); }

void listLocalityBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "locality", ".", kLocality);
  listAlone(all, "locality", ".strokes[].", kStrokes);
  for (const char* look : {".strokes[].look_before.", ".strokes[].look_after."})
    listAlone(all, "locality", look, kLook);
}

void printStrokeHeading(std::FILE* out) {
  fmt::print(
      out,
      "\nstrokes; far: beyond the brush's radius from its path, support radii; close: new points closer than 0.4 "
      "spacings to a neighbour; out: new points off the old surface, and how far, support radii; normals: 95th "
      "percentile of the angle of changed ones to a plane fit, degrees; turned: normals that face the wrong way, "
      "changed / at rest; settle: ticks until the last change; looks: points changed by a brush without effect, "
      "before / after the stroke; deep, high: largest distance of changed points under and over the old surface, "
      "mm; double: changed points with one that faces the other way within half a spacing\n");
  fmt::print(out, kRow, "model", "points", "backend", "brush", "way", "moved", "new", "gone", "far moved", "far new",
             "close", "out", "normals", "turned", "settle", "looks", "deep", "high", "double", "broken");
}

void printStroke(std::FILE* out, const StrokeRecord& record) {
  const EditVerdict& v = record.verdict;
  const auto changes = [](const IdleRecord& idle) { return idle.moved + idle.inserted + idle.removed; };
  const bool changed = v.moved + v.removed + v.painted > 0;
  fmt::print(out, kRow, record.subject, record.points, record.backend, record.brush, record.gesture,
             v.moved + v.painted, v.inserted, v.removed, changed ? fmt::format("{:.2f}", v.farthestMoved) : "–",
             v.inserted > 0 ? fmt::format("{:.2f}", v.farthestInserted) : "–",
             v.inserted > 0 ? fmt::format("{:.1f} %", 100 * share(v.crowded, v.inserted)) : "–",
             v.outside > 0 ? fmt::format("{}, {:.2f}", v.outside, v.farthestOutside) : "–",
             v.fitted > 0 ? fmt::format("{:.1f}", v.normal_deg) : "–", fmt::format("{} / {}", v.turned, v.turnedAtRest),
             record.settled ? fmt::format("{}", record.settling) : "never",
             fmt::format("{} / {}", changes(record.before), changes(record.after)),
             fmt::format("{:.2f}", record.deepest_mm), fmt::format("{:.2f}", record.highest_mm),
             fmt::format("{:.1f} %", 100 * share(v.doubled, v.changed)), fmt::join(record.broken(), ", "));
  std::fflush(out);
}

}  // namespace palpate
