#include "apps/bench/coexistence.hpp"

#include "apps/bench/bench.hpp"

namespace palpate {

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
