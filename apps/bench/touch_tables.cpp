#include "apps/bench/touch_tables.hpp"

#include <algorithm>
#include <map>

#include "apps/bench/bench.hpp"

namespace palpate {

namespace {

struct TouchColumn {
  const char* title;
  int width;
};

void printHead(std::FILE* out, const std::string& title, const std::vector<TouchColumn>& columns) {
  fmt::print(out, "\n{}\n{:<14}{:<21}{:<9}{:<8}", title, "shape", "condition", "surface", "machine");
  for (const TouchColumn& column : columns) fmt::print(out, "{:>{}}", column.title, column.width);
  fmt::print(out, "\n");
}

void printRow(std::FILE* out, const Judgement& j, const std::vector<TouchColumn>& columns,
              const std::vector<std::string>& cells) {
  fmt::print(out, "{:<14}{:<21}{:<9}{:<8}", j.subject, j.condition, j.surface, j.backend);
  for (std::size_t k = 0; k < cells.size(); ++k) fmt::print(out, "{:>{}}", cells[k], columns[k].width);
  fmt::print(out, "\n");
}

// About three digits, in a narrow column.
std::string brief(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size >= 99.5) return fmt::format("{:.0f}", value);
  if (size >= 9.95) return fmt::format("{:.1f}", value);
  if (size >= 0.0995) return fmt::format("{:.2f}", value);
  return size < 0.001 ? fmt::format("{:.0e}", value) : fmt::format("{:.2g}", value);
}

void printSlides(std::FILE* out, const TouchResults& results, double speed_mm_per_s) {
  const std::vector<TouchColumn> columns{{"held %", 7},  {"M1 mean", 9}, {"p95", 7},    {"max", 7},
                                         {"M2 bias", 9}, {"RMS", 7},     {"spac.", 8},  {"M3 %", 7},
                                         {"M4 p99", 9},  {"max", 7},     {"rough%", 8}, {"off edges", 10},
                                         {"M6 mean", 9}, {"max", 7},     {"ms", 8}};
  printHead(out,
            fmt::format("slides 1 mm deep at {:g} mm/s: M1 in degrees, M2 in um and in spacings, M4 in N/s, M6 in um",
                        speed_mm_per_s),
            columns);
  for (const Judgement& j : results.judgements)
    for (const SlideJudgement& s : j.slides)
      if (s.speed_mm_per_s == speed_mm_per_s)
        printRow(out, j, columns,
                 {brief(100 * s.heldShare), brief(s.angle.mean_deg), brief(s.angle.p95_deg), brief(s.angle.max_deg),
                  brief(1e3 * s.height.bias_mm), brief(1e3 * s.height.rms_mm), brief(s.height.rms_mm / j.spacing_mm),
                  brief(100 * s.forceError), brief(s.continuity.p99_N_per_s), brief(s.continuity.max_N_per_s),
                  brief(100 * s.continuity.roughShare), brief(100 * s.roughOffEdges), brief(1e3 * s.lag.mean_mm),
                  brief(1e3 * s.lag.max_mm), brief(s.lag.delay_ms)});
}

void printSessions(std::FILE* out, const TouchResults& results) {
  const std::vector<TouchColumn> columns{
      {"M7 p50", 8}, {"p99", 7},        {"p99.9", 7}, {"max", 8},    {"late %", 8},    {"M8 N", 7},  {"M10 Ft/Fn", 11},
      {"drift", 7},  {"M11 edits", 11}, {"ticks", 7}, {"step N", 8}, {"M12 same", 10}, {"cpu mN", 8}};
  printHead(out, "M7 ticks in us, M8 force in the air, M10 drift in um, M11 after an edit, M12 repeatability", columns);
  for (const Judgement& j : results.judgements) {
    const double tangential = j.slides.empty() ? 0 : j.slides.front().tangentialShare;
    std::vector<std::string> edit{"–", "–", "–"};
    if (j.edit)
      edit = {fmt::format("{}", j.edit->edits),
              j.edit->ticksUntilEqual ? fmt::format("{}", *j.edit->ticksUntilEqual) : "never",
              brief(j.edit->largestStep_N)};
    printRow(out, j, columns,
             {brief(j.step_us.p50), brief(j.step_us.p99), brief(j.step_us.p999), brief(j.step_us.max),
              brief(100 * j.lateShare), j.free_N ? brief(*j.free_N) : "–", brief(tangential), brief(1e3 * j.drift_mm),
              edit[0], edit[1], edit[2], j.identical ? "yes" : "NO", j.fromCpu_N ? brief(1e3 * *j.fromCpu_N) : "–"});
  }
}

void printSpeeds(std::FILE* out, const TouchResults& results) {
  std::vector<TouchColumn> columns;
  std::string title = "force direction (M1, degrees) and rough share of dF/dt (M4) at";
  for (const SlideJudgement& s : results.judgements.front().slides) {
    columns.insert(columns.end(), {{"mean", 12}, {"p95", 8}, {"max", 8}, {"rough%", 8}});
    title += fmt::format("{} {:g}", columns.size() > 4 ? "," : "", s.speed_mm_per_s);
  }
  printHead(out, title + " mm/s", columns);
  for (const Judgement& j : results.judgements) {
    std::vector<std::string> cells;
    for (const SlideJudgement& s : j.slides)
      cells.insert(cells.end(), {brief(s.angle.mean_deg), brief(s.angle.p95_deg), brief(s.angle.max_deg),
                                 brief(100 * s.continuity.roughShare)});
    printRow(out, j, columns, cells);
  }
}

void printPlates(std::FILE* out, const TouchResults& results) {
  fmt::print(out, "\nM5: pushes that came through a plate of two sides, %\n{:<9}{:<8}{:>10}", "surface", "machine",
             "mm/s");
  std::map<std::tuple<std::string, std::string, double>, std::map<double, double>> rows;
  for (const PlateJudgement& p : results.plates)
    rows[{p.surface, p.backend, p.speed_mm_per_s}][p.thicknessOverRadius] = p.throughShare;
  for (const auto& [thickness, share] : rows.begin()->second)
    fmt::print(out, "{:>12}", fmt::format("{:g} R", thickness));
  fmt::print(out, "\n");
  for (const auto& [key, shares] : rows) {
    fmt::print(out, "{:<9}{:<8}{:>10g}", std::get<0>(key), std::get<1>(key), std::get<2>(key));
    for (const auto& [thickness, share] : shares) fmt::print(out, "{:>12}", brief(100 * share));
    fmt::print(out, "\n");
  }
}

void printStability(std::FILE* out, const TouchResults& results) {
  fmt::print(
      out,
      "\nM9: largest stiffness that a hand holds steady on a plane, N/mm (simulated Touch, 1 kHz); least energy at "
      "0.4 N/mm, mJ\n{:>8} {:>17} {:>16} {:>12} {:>12}\n",
      "delay ms", "damping N s/mm", "passivity", "stiffness", "energy");
  for (const StabilityJudgement& s : results.stability)
    fmt::print(out, "{:>8g} {:>17g} {:>16} {:>12.2f} {:>12.3g}\n", s.delay_ms, s.damping_N_s_per_mm,
               s.controlled ? "controlled" : "observed", s.largest_N_per_mm, s.leastEnergy_mJ);
}

// Felt (0) or true (1) forces.
Json forcesOf(const std::vector<DVec2>& pairs, int which) {
  Json all = Json::array();
  for (const DVec2& pair : pairs) all.push_back(pair[which]);
  return all;
}

using Value = std::optional<Json>;

struct SlideRow {
  const SlideJudgement& slide;
  double spacing_mm;
};

constexpr Reported<SlideRow> kSlides[]{
    {"speed_mm_per_s", "mm/s", "speed", [](const SlideRow& r) -> Value { return r.slide.speed_mm_per_s; }},
    {"held_share", "1", "fraction of the ticks in contact",
     [](const SlideRow& r) -> Value { return r.slide.heldShare; }},
    {"M1_angle_deg.mean", "deg", "M1: mean angle between felt and true force",
     [](const SlideRow& r) -> Value { return r.slide.angle.mean_deg; }},
    {"M1_angle_deg.p95", "deg", "its 95th percentile",
     [](const SlideRow& r) -> Value { return r.slide.angle.p95_deg; }},
    {"M1_angle_deg.max", "deg", "its maximum", [](const SlideRow& r) -> Value { return r.slide.angle.max_deg; }},
    {"M2_height.bias_mm", "mm", "M2: mean height of the proxy over the true surface",
     [](const SlideRow& r) -> Value { return r.slide.height.bias_mm; }},
    {"M2_height.rms_mm", "mm", "its root mean square",
     [](const SlideRow& r) -> Value { return r.slide.height.rms_mm; }},
    {"M2_height.bias_spacings", "spacings", "the mean in spacings",
     [](const SlideRow& r) -> Value { return r.slide.height.bias_mm / r.spacing_mm; }},
    {"M2_height.rms_spacings", "spacings", "the root mean square in spacings",
     [](const SlideRow& r) -> Value { return r.slide.height.rms_mm / r.spacing_mm; }},
    {"M3_force_relative_rms", "1", "M3: root mean square of the error of the force, relative",
     [](const SlideRow& r) -> Value { return r.slide.forceError; }},
    {"M4_continuity.p99_N_per_s", "N/s", "M4: 99th percentile of the change of force",
     [](const SlideRow& r) -> Value { return r.slide.continuity.p99_N_per_s; }},
    {"M4_continuity.max_N_per_s", "N/s", "its maximum",
     [](const SlideRow& r) -> Value { return r.slide.continuity.max_N_per_s; }},
    {"M4_continuity.share_50_to_500_Hz", "1", "fraction of its power between 50 and 500 Hz",
     [](const SlideRow& r) -> Value { return r.slide.continuity.roughShare; }},
    {"M4_continuity.share_50_to_500_Hz_off_edges", "1", "the same away from edges",
     [](const SlideRow& r) -> Value { return r.slide.roughOffEdges; }},
    {"M6_lag.mean_mm", "mm", "M6: mean distance of the proxy from the god-object on the truth",
     [](const SlideRow& r) -> Value { return r.slide.lag.mean_mm; }},
    {"M6_lag.max_mm", "mm", "its maximum", [](const SlideRow& r) -> Value { return r.slide.lag.max_mm; }},
    {"M6_lag.delay_ms", "ms", "delay of the proxy", [](const SlideRow& r) -> Value { return r.slide.lag.delay_ms; }},
    {"M10_tangential_over_normal", "1", "M10: tangential over normal force",
     [](const SlideRow& r) -> Value { return r.slide.tangentialShare; }},
};

constexpr Reported<EditJudgement> kJudgedEdit[]{
    {"edits", "", "edits", field<&EditJudgement::edits>},
    {"ticks_until_equal", "", "ticks until the surface equals one built from its points; null: never",
     [](const EditJudgement& r) -> Value { return orNull(r.ticksUntilEqual); }},
    {"largest_step_N", "N", "largest change of force from tick to tick", field<&EditJudgement::largestStep_N>},
};

constexpr Reported<Judgement> kJudgements[]{
    {"backend", "", "back end", field<&Judgement::backend>},
    {"surface", "", "surface", field<&Judgement::surface>},
    {"subject", "", "shape or model", field<&Judgement::subject>},
    {"condition", "", "condition of the cloud", field<&Judgement::condition>},
    {"points", "", "its points", field<&Judgement::points>},
    {"spacing_mm", "mm", "mean distance of neighbouring points", field<&Judgement::spacing_mm>},
    {"radius_mm", "mm", "largest support radius", field<&Judgement::radius_mm>},
    {"measured_noise_spacings", "spacings", "measured noise of the positions", field<&Judgement::noise_spacings>},
    {"slides", "", "slides, by speed",
     [](const Judgement& j) -> Value {
       Json slides = Json::array();
       for (const SlideJudgement& slide : j.slides) slides.push_back(jsonBy(kSlides, SlideRow{slide, j.spacing_mm}));
       return slides;
     }},
    {"M7_step_us.p50", "us", "M7: median time of a tick", [](const Judgement& r) -> Value { return r.step_us.p50; }},
    {"M7_step_us.p99", "us", "99th percentile", [](const Judgement& r) -> Value { return r.step_us.p99; }},
    {"M7_step_us.p999", "us", "99.9th percentile", [](const Judgement& r) -> Value { return r.step_us.p999; }},
    {"M7_step_us.max", "us", "maximum", [](const Judgement& r) -> Value { return r.step_us.max; }},
    {"M7_step_us.late_share", "1", "fraction of the ticks that exceed their millisecond",
     [](const Judgement& r) -> Value { return r.lateShare; }},
    {"M8_free_force_N", "N", "M8: largest force in the air; null: not measured",
     [](const Judgement& r) -> Value { return orNull(r.free_N); }},
    {"M10_friction.mu", "1", "M10: requested coefficient of friction",
     [](const Judgement& r) -> Value { return r.friction; }},
    {"M10_friction.drift_mm", "mm", "drift at rest", [](const Judgement& r) -> Value { return r.drift_mm; }},
    {"M11_edit", "", "M11: after an edit; null: not measured",
     [](const Judgement& r) -> Value { return r.edit ? jsonBy(kJudgedEdit, *r.edit) : Json(nullptr); }},
    {"M12_repeatability.identical", "", "M12: whether the same path gives the same forces twice",
     [](const Judgement& r) -> Value { return r.identical; }},
    {"M12_repeatability.from_cpu_N", "N", "largest difference from the CPU's forces; null: the CPU itself",
     [](const Judgement& r) -> Value { return orNull(r.fromCpu_N); }},
    {"slide_N.felt", "N", "force along the first slide at the main speed, tick by tick",
     [](const Judgement& r) -> Value { return forcesOf(r.force_N, 0); }},
    {"slide_N.true", "N", "the true force there", [](const Judgement& r) -> Value { return forcesOf(r.force_N, 1); }},
};

constexpr Reported<PlateJudgement> kPlates[]{
    {"backend", "", "back end", field<&PlateJudgement::backend>},
    {"surface", "", "surface", field<&PlateJudgement::surface>},
    {"thickness_over_radius", "1", "thickness of the plate over the support radius",
     field<&PlateJudgement::thicknessOverRadius>},
    {"speed_mm_per_s", "mm/s", "speed", field<&PlateJudgement::speed_mm_per_s>},
    {"pushes", "", "pushes", field<&PlateJudgement::pushes>},
    {"through_share", "1", "fraction of them that came through the plate", field<&PlateJudgement::throughShare>},
};

constexpr Reported<StabilityJudgement> kStability[]{
    {"surface", "", "plane", [](const StabilityJudgement&) -> Value { return "plane"; }},
    {"delay_ms", "ms", "delay of the force", field<&StabilityJudgement::delay_ms>},
    {"damping_N_s_per_mm", "N s/mm", "damping", field<&StabilityJudgement::damping_N_s_per_mm>},
    {"passivity", "", "controlled or observed",
     [](const StabilityJudgement& r) -> Value { return r.controlled ? "controlled" : "observed"; }},
    {"largest_stiffness_N_per_mm", "N/mm", "largest stiffness that a hand holds steady",
     field<&StabilityJudgement::largest_N_per_mm>},
    {"min_energy_mJ", "mJ", "smallest energy at 0.4 N/mm", field<&StabilityJudgement::leastEnergy_mJ>},
};

constexpr Reported<TouchResults> kTouchBench[]{
    {"judgements", "", "one for each shape, condition, surface and back end",
     [](const TouchResults& r) -> Value { return arrayBy(kJudgements, r.judgements); }},
    {"M5_plates", "", "M5: pushes through a plate of two sides",
     [](const TouchResults& r) -> Value { return arrayBy(kPlates, r.plates); }},
    {"M9_stability", "", "M9: stiffness that a hand holds steady",
     [](const TouchResults& r) -> Value { return arrayBy(kStability, r.stability); }},
};

}  // namespace

void printTouchTables(std::FILE* out, const TouchResults& results, double mainSpeed_mm_per_s) {
  if (!results.judgements.empty()) {
    printSlides(out, results, mainSpeed_mm_per_s);
    printSpeeds(out, results);
    printSessions(out, results);
  }
  if (!results.plates.empty()) printPlates(out, results);
  if (!results.stability.empty()) printStability(out, results);
}

Json toJson(const TouchResults& results) { return jsonBy(kTouchBench, results); }

void listTouchBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "touch", ".", kTouchBench);
  listAlone(all, "touch", ".judgements[].", kJudgements);
  listAlone(all, "touch", ".judgements[].slides[].", kSlides);
  listAlone(all, "touch", ".judgements[].M11_edit.", kJudgedEdit);
  listAlone(all, "touch", ".M5_plates[].", kPlates);
  listAlone(all, "touch", ".M9_stability[].", kStability);
}

}  // namespace palpate
