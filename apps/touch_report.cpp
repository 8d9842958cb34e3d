#include "apps/touch_report.hpp"

#include <algorithm>

#include "engine/contact/contact_reference.hpp"

namespace palpate {

ContactError contactError(const Trace& trace, const Model& model, double radius, std::size_t firstEdit) {
  constexpr std::size_t kMostTicks = 200;
  std::vector<const TraceRow*> rows;
  for (std::size_t i = 0; i < std::min(firstEdit, trace.rows.size()); ++i)
    if (trace.rows[i].contact) rows.push_back(&trace.rows[i]);
  ContactError error;
  if (rows.empty()) return error;
  const ContactReference reference(model.cloud, radius);
  const std::size_t stride = (rows.size() + kMostTicks - 1) / kMostTicks;
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    const SurfaceSample surface = reference.surface(rows[i]->proxy - model.cloud.origin);
    error.worst_mm = std::max(error.worst_mm, model.scale.toMm(std::abs(surface.distance)));
    ++error.ticks;
  }
  return error;
}

void printReport(std::FILE* out, const TouchReport& report) {
  const auto row = [&](std::string_view what, const std::string& value) { fmt::print(out, "{:<22}{}\n", what, value); };
  const TraceSummary& trace = report.trace;
  row("points", fmt::format("{}", report.points));
  row("GPU", report.gpu);
  row("index build", fmt::format("{:.1f} us", report.build_us));
  row("ticks", fmt::format("{}, {} in contact", trace.ticks, trace.contactTicks));
  row("step p50 / p99.9", fmt::format("{:.1f} / {:.1f} us (pose to force)", trace.step_us.p50, trace.step_us.p999));
  row("GPU time p50 / p99.9", fmt::format("{:.1f} / {:.1f} us", trace.gpu_us.p50, trace.gpu_us.p999));
  if (report.edits)
    row("edit p50 / p99.9", fmt::format("{:.1f} / {:.1f} us (GPU, {} ticks), {} points moved", report.edit_us.p50,
                                        report.edit_us.p999, report.edit_us.count, report.movedPoints));
  row("contact error", report.contactErrorTicks
                           ? fmt::format("{:.2g} mm, largest of {} ticks against double precision",
                                         report.contactError_mm, report.contactErrorTicks)
                           : std::string("nothing was touched before the first edit"));
  row("peak force", fmt::format("{:.3f} N", trace.peakForce_N));
  if (report.realtime)
    row("missed ticks", fmt::format("{}{}", trace.missedTicks,
                                    report.realtimePriority ? "" : " (no real-time priority was granted)"));
  if (report.skippedEdits) row("edits left out", fmt::format("{} (the picture fell behind)", report.skippedEdits));
}

Json toJson(const TouchReport& report) {
  const auto summary = [](const Summary& s) {
    return Json{{"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
  };
  const TraceSummary& trace = report.trace;
  Json json{{"points", report.points},
            {"ticks", trace.ticks},
            {"contact_ticks", trace.contactTicks},
            {"step_us", summary(trace.step_us)},
            {"gpu_us", summary(trace.gpu_us)},
            {"build_us", report.build_us},
            {"fresh_fraction", trace.freshFraction},
            {"peak_force_N", trace.peakForce_N},
            {"moved_points", report.movedPoints},
            {"gpu", report.gpu},
            {"method", "fused"},
            {"index", "rebuild"},
            {"contact_error_mm", report.contactErrorTicks ? Json(report.contactError_mm) : Json(nullptr)},
            {"missed_ticks", trace.missedTicks},
            {"skipped_edits", report.skippedEdits}};
  if (report.edits) {
    json["edit_us"] = summary(report.edit_us);
    json["edit_ticks"] = report.edit_us.count;
  }
  return json;
}

}  // namespace palpate
