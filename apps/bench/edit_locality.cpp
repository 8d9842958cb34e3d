#include "apps/bench/edit_locality.hpp"

#include <fmt/ranges.h>

namespace palpate {

namespace {

constexpr std::string_view kRow =
    "{:<20}{:>8} {:<8}{:<8}{:<6}{:>7}{:>7}{:>7}{:>11}{:>9}{:>9}{:>13}{:>8}{:>12}{:>7}{:>10}{:>7}{:>6}{:>8}  {}\n";

double share(std::size_t part, std::size_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

Json toJson(const IdleRecord& idle) {
  return {{"ticks", idle.ticks}, {"moved", idle.moved}, {"inserted", idle.inserted}, {"removed", idle.removed}};
}

}  // namespace

std::vector<std::string_view> StrokeRecord::broken(bool strict) const {
  std::vector<std::string_view> broken = verdict.broken(carves, strict);
  if (before.changed()) broken.emplace_back("look changes");
  if (!settled) broken.emplace_back("never settles");
  if (after.changed()) broken.emplace_back("settled look changes");
  return broken;
}

Json toJson(const StrokeRecord& record) {
  const EditVerdict& v = record.verdict;
  return {{"subject", record.subject},
          {"points", record.points},
          {"backend", record.backend},
          {"brush", record.brush},
          {"gesture", record.gesture},
          {"spacing_mm", record.spacing_mm},
          {"radius_mm", record.radius_mm},
          {"brush_radius_mm", record.brushRadius_mm},
          {"ticks", record.ticks},
          {"acting_ticks", record.acting},
          {"moved", v.moved},
          {"painted", v.painted},
          {"inserted", v.inserted},
          {"removed", v.removed},
          {"farthest_moved_R", v.farthestMoved},
          {"farthest_inserted_R", v.farthestInserted},
          {"crowded_share", share(v.crowded, v.inserted)},
          {"nearest_spacings", v.nearest},
          {"outside", v.outside},
          {"farthest_outside_R", v.farthestOutside},
          {"deepest_mm", record.deepest_mm},
          {"highest_mm", record.highest_mm},
          {"doubled_share", share(v.doubled, v.changed)},
          {"normals", {{"fitted", v.fitted}, {"p95_deg", v.normal_deg}, {"sided", v.sided}, {"turned", v.turned}}},
          {"turned_at_rest", v.turnedAtRest},
          {"settling_ticks", record.settling},
          {"settled", record.settled},
          {"look_before", toJson(record.before)},
          {"look_after", toJson(record.after)},
          {"broken", record.broken()},
          {"strictly_broken", record.broken(true)}};
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
