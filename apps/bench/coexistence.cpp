#include "apps/bench/coexistence.hpp"

#include <algorithm>

namespace palpate {

void printCoexistences(std::FILE* out, const std::vector<Coexistence>& all) {
  fmt::print(out, "{:<16}{:>10}  {:<13}{:<18}{:>9}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}{:>10}{:>9}{:>22}{:>20}\n",
             "model", "points", "queues", "situation", "ticks", "missed", "p50", "p99", "p99.9", "max", "in time",
             "late p99.9", "edits/s", "fps", "picture, ms", "of it following");
  const auto pair = [](const Summary& s) { return fmt::format("{:.2f} / {:.2f}", s.p50, s.p999); };
  for (const Coexistence& c : all) {
    const std::string editRate =
        c.brushRadius_mm > 0 ? fmt::format("{:.0f}", static_cast<double>(c.edits) / c.duration_s) : "–";
    fmt::print(out, "{:<16}{:>10}  {:<13}{:<18}{:>9}{:>8}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>8.2f}%{:>11.1f}{:>10}",
               c.subject, c.points, c.queues, c.situation, c.ticks, c.missedTicks, c.step_us.p50, c.step_us.p99,
               c.step_us.p999, c.step_us.max, 100 * c.freshShare, c.lateP999_us, editRate);
    if (c.sight)
      fmt::print(out, "{:>9.0f}{:>22}{:>20}\n", c.sight->perSecond, pair(c.sight->picture_ms),
                 pair(c.sight->follow_ms));
    else
      fmt::print(out, "{:>9}{:>22}{:>20}\n", "–", "–", "–");
  }
  if (!std::ranges::all_of(all, &Coexistence::realtimePriority))
    fmt::print(out, "No real-time priority was granted: the scheduler may wake a tick late.\n");
}

Json toJson(const Coexistence& c) {
  const auto summary = [](const Summary& s) -> Json {
    return {{"n", s.count}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
  };
  Json json{{"subject", c.subject},
            {"points", c.points},
            {"backend", c.backend},
            {"queues", c.queues},
            {"situation", c.situation},
            {"rate_Hz", c.rate_Hz},
            {"duration_s", c.duration_s},
            {"ticks", c.ticks},
            {"missed_ticks", c.missedTicks},
            {"contact_ticks", c.contactTicks},
            {"fresh_fraction", c.freshShare},
            {"step_us", summary(c.step_us)},
            {"late_us", {{"p999", c.lateP999_us}, {"max", c.lateMost_us}}},
            {"realtime_priority", c.realtimePriority},
            {"edits", c.edits},
            {"dropped_edits", c.leftOut},
            {"states_made", c.statesMade},
            {"brush_radius_mm", c.brushRadius_mm}};
  if (c.sight)
    json["sight"] = {{"gpu", c.sight->gpu},
                     {"pictures", c.sight->pictures},
                     {"fps", c.sight->perSecond},
                     {"picture_ms", summary(c.sight->picture_ms)},
                     {"follow_ms", summary(c.sight->follow_ms)},
                     {"states_seen", c.sight->statesSeen},
                     {"changed_pixels", c.sight->changedPixels}};
  return json;
}

}  // namespace palpate
