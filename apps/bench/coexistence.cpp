#include "apps/bench/coexistence.hpp"

#include <algorithm>

#include "apps/bench/bench.hpp"

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

namespace {

using Value = std::optional<Json>;

template <auto member>
Value upperQuantiles(decltype(ownerOf(member)) report) {
  const Summary& s = report.*member;
  return Json{{"n", s.count}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

constexpr Reported<SightPace> kSight[]{
    {"gpu", "", "GPU that drew", field<&SightPace::gpu>},
    {"pictures", "", "pictures drawn", field<&SightPace::pictures>},
    {"fps", "1/s", "pictures per second", field<&SightPace::perSecond>},
    {"picture_ms", "ms", "time from reading the edits until the picture is complete",
     upperQuantiles<&SightPace::picture_ms>},
    {"follow_ms", "ms", "the part of it spent on the edits", upperQuantiles<&SightPace::follow_ms>},
    {"states_seen", "", "states of edited points received", field<&SightPace::statesSeen>},
    {"changed_pixels", "", "pixels that differ between the first picture and the last",
     field<&SightPace::changedPixels>},
};

constexpr Reported<Coexistence> kCoexistence[]{
    {"subject", "", "model", field<&Coexistence::subject>},
    {"points", "", "its points", field<&Coexistence::points>},
    {"backend", "", "back end", field<&Coexistence::backend>},
    {"queues", "", "arrangement of the GPU's queues", field<&Coexistence::queues>},
    {"situation", "", "whether the hand sculpts and pictures are drawn", field<&Coexistence::situation>},
    {"rate_Hz", "Hz", "ticks per second", field<&Coexistence::rate_Hz>},
    {"duration_s", "s", "duration of the stroke", field<&Coexistence::duration_s>},
    {"ticks", "", "ticks of the stroke", field<&Coexistence::ticks>},
    {"missed_ticks", "", "ticks skipped because their time had passed", field<&Coexistence::missedTicks>},
    {"contact_ticks", "", "ticks in contact", field<&Coexistence::contactTicks>},
    {"fresh_fraction", "1", "fraction of ticks answered in time", field<&Coexistence::freshShare>},
    {"step_us", "us", "time from pose to force", upperQuantiles<&Coexistence::step_us>},
    {"late_us.p999", "us", "99.9th percentile of the wake-up latency", field<&Coexistence::lateP999_us>},
    {"late_us.max", "us", "its maximum", field<&Coexistence::lateMost_us>},
    {"realtime_priority", "", "whether the servo thread had real-time priority", field<&Coexistence::realtimePriority>},
    {"edits", "", "edits of the stroke", field<&Coexistence::edits>},
    {"dropped_edits", "", "dropped edits", field<&Coexistence::leftOut>},
    {"states_made", "", "states of points that the edits produced", field<&Coexistence::statesMade>},
    {"brush_radius_mm", "mm", "radius of the brush; 0: no edits", field<&Coexistence::brushRadius_mm>},
    {"sight", "", "the pictures, if any were drawn",
     [](const Coexistence& c) -> Value { return partBy(kSight, c.sight); }},
};

constexpr Reported<CoexistenceResults> kCoexist[]{
    {"size", "px", "width and height of a picture",
     [](const CoexistenceResults& r) -> Value {
       return Json{r.width, r.height};
     }},
    {"samples", "", "samples of a pixel", field<&CoexistenceResults::samples>},
    {"rows", "", "one for each stroke",
     [](const CoexistenceResults& r) -> Value { return arrayBy(kCoexistence, r.rows); }},
};

}  // namespace

Json toJson(const CoexistenceResults& results) { return jsonBy(kCoexist, results); }

void listCoexistBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "coexist", ".", kCoexist);
  listAlone(all, "coexist", ".rows[].", kCoexistence);
  listAlone(all, "coexist", ".rows[].sight.", kSight);
}

}  // namespace palpate
