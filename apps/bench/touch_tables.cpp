#include "apps/bench/touch_tables.hpp"

#include <algorithm>
#include <map>

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
  printHead(out, "M7 ticks in us, M8 force in the air, M10 drift in um, M11 after an edit, M12 sameness", columns);
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

Json toJson(const SlideJudgement& s, double spacing_mm) {
  return {{"speed_mm_per_s", s.speed_mm_per_s},
          {"held_share", s.heldShare},
          {"M1_angle_deg", {{"mean", s.angle.mean_deg}, {"p95", s.angle.p95_deg}, {"max", s.angle.max_deg}}},
          {"M2_height",
           {{"bias_mm", s.height.bias_mm},
            {"rms_mm", s.height.rms_mm},
            {"bias_spacings", s.height.bias_mm / spacing_mm},
            {"rms_spacings", s.height.rms_mm / spacing_mm}}},
          {"M3_force_relative_rms", s.forceError},
          {"M4_continuity",
           {{"p99_N_per_s", s.continuity.p99_N_per_s},
            {"max_N_per_s", s.continuity.max_N_per_s},
            {"share_50_to_500_Hz", s.continuity.roughShare},
            {"share_50_to_500_Hz_off_edges", s.roughOffEdges}}},
          {"M6_lag", {{"mean_mm", s.lag.mean_mm}, {"max_mm", s.lag.max_mm}, {"delay_ms", s.lag.delay_ms}}},
          {"M10_tangential_over_normal", s.tangentialShare}};
}

Json toJson(const Judgement& j) {
  Json json{{"backend", j.backend},     {"surface", j.surface},
            {"subject", j.subject},     {"condition", j.condition},
            {"points", j.points},       {"spacing_mm", j.spacing_mm},
            {"radius_mm", j.radius_mm}, {"measured_noise_spacings", j.noise_spacings},
            {"slides", Json::array()}};
  for (const SlideJudgement& s : j.slides) json["slides"].push_back(toJson(s, j.spacing_mm));
  json["M7_step_us"] = {{"p50", j.step_us.p50},
                        {"p99", j.step_us.p99},
                        {"p999", j.step_us.p999},
                        {"max", j.step_us.max},
                        {"late_share", j.lateShare}};
  json["M8_free_force_N"] = j.free_N ? Json(*j.free_N) : Json(nullptr);
  json["M10_friction"] = {{"mu", j.friction}, {"drift_mm", j.drift_mm}};
  json["M11_edit"] = nullptr;
  if (j.edit)
    json["M11_edit"] = {{"edits", j.edit->edits},
                        {"ticks_until_equal", j.edit->ticksUntilEqual ? Json(*j.edit->ticksUntilEqual) : Json(nullptr)},
                        {"largest_step_N", j.edit->largestStep_N}};
  json["M12_sameness"] = {{"identical", j.identical}, {"from_cpu_N", j.fromCpu_N ? Json(*j.fromCpu_N) : Json(nullptr)}};
  json["slide_N"] = {{"felt", Json::array()}, {"true", Json::array()}};
  for (const DVec2& pair : j.force_N) {
    json["slide_N"]["felt"].push_back(pair.x);
    json["slide_N"]["true"].push_back(pair.y);
  }
  return json;
}

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

Json toJson(const TouchResults& results) {
  Json json{{"judgements", Json::array()}, {"M5_plates", Json::array()}, {"M9_stability", Json::array()}};
  for (const Judgement& judgement : results.judgements) json["judgements"].push_back(toJson(judgement));
  for (const PlateJudgement& p : results.plates)
    json["M5_plates"].push_back({{"backend", p.backend},
                                 {"surface", p.surface},
                                 {"thickness_over_radius", p.thicknessOverRadius},
                                 {"speed_mm_per_s", p.speed_mm_per_s},
                                 {"pushes", p.pushes},
                                 {"through_share", p.throughShare}});
  for (const StabilityJudgement& s : results.stability)
    json["M9_stability"].push_back({{"surface", "plane"},
                                    {"delay_ms", s.delay_ms},
                                    {"damping_N_s_per_mm", s.damping_N_s_per_mm},
                                    {"passivity", s.controlled ? "controlled" : "observed"},
                                    {"largest_stiffness_N_per_mm", s.largest_N_per_mm},
                                    {"min_energy_mJ", s.leastEnergy_mJ}});
  return json;
}

}  // namespace palpate
