// The text of a touch session.
#include <algorithm>

#include "apps/cli/tick_times.hpp"
#include "apps/cli/touch_report.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

// "3.41 s: model 2.10, hands 0.31, session 0.90, first answer 0.10".
std::string inWords(const std::vector<StartStage>& start) {
  double all_s = 0;
  std::string stages;
  for (const StartStage& stage : start) {
    all_s += stage.time_s;
    stages += fmt::format("{}{} {:.2f}", stages.empty() ? "" : ", ", stage.name, stage.time_s);
  }
  return fmt::format("{:.2f} s: {}", all_s, stages);
}

std::string inWords(const PlayCounts& frames) {
  std::string text = fmt::format("{} played, {} lost, {} dropped", frames.played, frames.lost, frames.dropped);
  if (frames.silentSince_s) text += fmt::format("; none received since {:.3f} s", *frames.silentSince_s);
  if (frames.lost > 0) text += fmt::format("; last loss: {}", frames.lastLoss);
  return text;
}

std::string inWords(const SharedCounts& shared) {
  std::string words = fmt::format("{} point states sent, {} received", shared.sent, shared.received);
  const LinkCounts& link = shared.link;
  if (link.roundTrip_ms)
    words += fmt::format("; round trip {:.1f} ms, {:.0f} % of {} pings lost", *link.roundTrip_ms,
                         link.lost_percent.value_or(0), link.pings);
  words += fmt::format("; longest silence {:.1f} s, information at most {:.1f} s old", shared.longestSilent_s,
                       shared.oldest_s);
  if (!shared.delivered) return words + "; NOT all edits are delivered";
  if (!shared.idle) return words + "; all edits are delivered, others continue";
  return words + (shared.same ? "; the points equal the server's" : "; the points do NOT equal the server's");
}

std::string inWords(std::span<const SeenHand> hands) {
  std::string names;
  for (const SeenHand& hand : hands) names += (names.empty() ? "" : "; ") + hand.name;
  return names;
}

std::string inWords(const FarReport& far) {
  const FarCounts& counts = far.counts;
  std::string words = fmt::format(
      "{} of {} ticks lacked points around a hand and had no force; {} received in {}, at most {} "
      "at a time",
      far.ticks.without, far.ticks.ticks, counted(counts.points, "point"), counted(counts.updates, "step"),
      counts.mostKnown);
  if (counts.sent > 0)
    words += fmt::format("; {} point states edited here{}", counts.sent,
                         counts.delivered ? ", all delivered" : ", NOT all delivered");
  if (counts.roundTrip_ms) words += fmt::format("; round trip {:.1f} ms", *counts.roundTrip_ms);
  words += fmt::format("; longest silence {:.1f} s", counts.longestSilent_s);
  if (counts.restarts > 0)
    words += fmt::format("; the simulation was restarted {}",
                         counts.restarts == 1 ? std::string("once") : fmt::format("{} times", counts.restarts));
  if (counts.servers > 1) words += fmt::format("; server restarts: {}", counts.servers - 1);
  return words;
}

/// Prints the rows of a report.
class Rows {
 public:
  Rows(std::FILE* out, const TouchReport& report) : out_(out), report_(report) {}

  void print(std::string_view what, const std::string& value) const { fmt::print(out_, "{:<22}{}\n", what, value); }
  std::string length(double mm) const {
    return lengthText(ModelScale{report_.mm_per_unit}.toUnits(mm), report_.unit, kFewLengthDigits);
  }

 private:
  std::FILE* out_;
  const TouchReport& report_;
};

void printParticipants(const Rows& rows, const TouchReport& report) {
  if (report.ros)
    rows.print("ROS",
               fmt::format("{} sent, {} dropped (queue full)", counted(report.ros->ticks, "tick"), report.ros->lost));
  if (report.shared) rows.print("others", inWords(*report.shared));
  if (!report.others.empty()) rows.print("others' hands", inWords(std::span(report.others)));
  if (report.cameras.value_or(0) > 0) rows.print("others' cameras", fmt::format("{}", *report.cameras));
  if (report.far) rows.print("near points", inWords(*report.far));
}

void printMatter(const Rows& rows, const MatterReport& matter, std::size_t particles) {
  std::string steps = fmt::format("{} of {}, {} substeps per millisecond", particles,
                                  matter.isSoft ? "a soft body" : matter.scene.matter, matter.scene.substeps);
  if (matter.duration_s > 0)
    steps += fmt::format(", {:.0f} advances per second", static_cast<double>(matter.advances) / matter.duration_s);
  if (matter.dropped_s > 0) steps += fmt::format("; {:.3f} s dropped, behind the clock", matter.dropped_s);
  rows.print(matter.isSoft ? "points" : "particles", steps);
  if (!matter.scene.elasticity.empty()) rows.print("material", matter.scene.elasticity);
  std::string force = fmt::format("{:g} times the simulated one", matter.scene.gain);
  if (matter.scene.coupling_N_mm > 0)
    force += fmt::format("; spring between hand and ball {:.3g} N/mm", matter.scene.coupling_N_mm);
  if (matter.holds.gaveWayTicks > 0)
    force += fmt::format("; the body yielded to a hand in {}", counted(matter.holds.gaveWayTicks, "tick"));
  rows.print("force", force);
  for (const PortEnergy& port : matter.ports)
    rows.print("energy of a hand",
               fmt::format("{:.3g} mJ put in, minimum {:.3g} mJ", 1e3 * port.now_J, 1e3 * port.min_J));
}

void printModel(const Rows& rows, const TouchReport& report) {
  if (report.matter)
    printMatter(rows, *report.matter, report.points);
  else
    rows.print("points",
               fmt::format("{}, spacing {}, noise {:.2f} spacings, support radius {}", report.points,
                           rows.length(report.spacing_mm), report.noise_spacings, rows.length(report.radius_mm)));
  if (!report.matter) rows.print("touch scale", touchScaleText({report.mm_per_unit}, report.longestSide, report.unit));
  if (report.frames) rows.print("frames", inWords(*report.frames));
  rows.print("machine", fmt::format("{} ({})", report.machine, report.backend));
  if (!report.start.empty()) rows.print("ready after", inWords(report.start));
  if (!report.matter) rows.print("index build", fmt::format("{:.1f} us", report.build_us));
}

void printTicks(const Rows& rows, const TouchReport& report) {
  const TraceSummary& trace = report.trace;
  rows.print("ticks", fmt::format("{}, {} in contact", trace.ticks, trace.contactTicks));
  rows.print("step p50 / p99.9",
             fmt::format("{:.1f} / {:.1f} us (pose to force)", trace.step_us.p50, trace.step_us.p999));
  if (trace.gpu_us.count)
    rows.print("GPU time p50 / p99.9", fmt::format("{:.1f} / {:.1f} us", trace.gpu_us.p50, trace.gpu_us.p999));
  if (report.edits)
    rows.print("edit p50 / p99.9",
               fmt::format("{:.1f} / {:.1f} us ({}), {} moved", report.edit_us.p50, report.edit_us.p999,
                           counted(report.edit_us.count, "tick"), counted(report.movedPoints, "point")));
  if (report.blocked.edits)
    rows.print("too thin", fmt::format("nearly nothing under the brush could move in {}, before a side that stays",
                                       counted(report.blocked.edits, "edit")));
  if (report.blocked.fromBehind)
    rows.print("from behind",
               fmt::format("nothing changed in {}: the hand was behind the surface; --normals flip turns it",
                           counted(report.blocked.fromBehind, "edit")));
  if (report.shape) rows.print("shape", fmt::format("strokes that changed the rest shape: {}", report.shape->strokes));
  if (trace.contactTicks == 0 && !report.matter)
    rows.print("contact",
               "none: the HIP never crossed the surface from outside; check the path, and that the support radius "
               "is some spacings wide");
  if (report.error.ticks)
    rows.print("contact error", fmt::format("{}, largest of {} against double precision{}",
                                            rows.length(report.error.worst_mm), counted(report.error.ticks, "tick"),
                                            report.error.undefined ? fmt::format("; {} of them without a surface there",
                                                                                 report.error.undefined)
                                                                   : std::string()));
}

void printForces(const Rows& rows, const TouchReport& report) {
  const TraceSummary& trace = report.trace;
  rows.print("peak force", fmt::format("{:.3f} N", trace.peakForce_N));
  if (!report.remembered.empty()) rows.print("remembered", report.remembered + ", for this device");
  if (report.matter && report.matter->scene.coupling_N_mm > 0)
    rows.print("peak torque", fmt::format("{:.3g} mN m about the middle of the ball", trace.peakTorque_mNm));
  if (report.toolPoints)
    rows.print("peak torque", fmt::format("{:.3f} mN m about the HIP, of a {} with {}", trace.peakTorque_mNm,
                                          report.tool, counted(report.toolPoints, "point")));
  for (std::size_t i = 0; i < report.hands.size(); ++i) {
    const auto& [device, felt, counts] = report.hands[i];
    rows.print(
        fmt::format("hand {}", i + 2),
        fmt::format("{}: {} in contact, peak force {:.3f} N{}", device, counted(felt.contactTicks, "tick"),
                    felt.peakForce_N,
                    report.realtime ? fmt::format(", {:.1f} % of answers in time", 100 * felt.freshFraction) : ""));
  }
}

void printTimes(const Rows& rows, const TouchReport& report) {
  if (!report.realtime) return;
  const TraceSummary& trace = report.trace;
  rows.print("missed ticks",
             fmt::format("{}, {:.1f} % of answers in time{}", trace.missedTicks, 100 * trace.freshFraction,
                         report.pacedByDevice      ? " (at the device's own pace)"
                         : report.realtimePriority ? ""
                                                   : " (no real-time priority was granted)"));
  rows.print("tick times", inWords(report.servo.step_us));
  rows.print("wake-up latency", inWords(report.servo.late_us));
  if (!report.pacedByDevice) rows.print("preempted", inWords(report.servo.scheduling));
}

void printLimits(const Rows& rows, const TouchReport& report) {
  const TouchShortfalls& shortfalls = report.shortfalls;
  if (report.servo.leastEnergy_mJ)
    rows.print("passivity",
               fmt::format("minimum {:.3g} mJ (below 0: energy generated by the loop)", *report.servo.leastEnergy_mJ));
  const GateCounts& withheld = report.servo.withheld;
  if (withheld.aged)
    rows.print("force faded out", fmt::format("on {}: no update from the server", counted(withheld.aged, "tick")));
  if (withheld.errors + withheld.stale + withheld.hot)
    rows.print("force reduced",
               fmt::format("after {}, on {} with old data and {} with hot motors", counted(withheld.errors, "error"),
                           counted(withheld.stale, "tick"), withheld.hot));
  if (report.bridge_us.count)
    rows.print(
        "late answers bridged",
        fmt::format("p50 / p99.9 {:.1f} / {:.1f} us on the CPU, from the last patch of points{}", report.bridge_us.p50,
                    report.bridge_us.p999, shortfalls.thinnedPatches ? "; some subsampled" : ""));
}

void printStrokes(const Rows& rows, const TouchReport& report) {
  const TraceSummary& trace = report.trace;
  if (report.back) {
    const UndoneStrokes& back = *report.back;
    rows.print("undo", fmt::format("{} of {} strokes undone, {} redone", back.undone, back.strokes, back.redone));
    if (back.dropped)
      rows.print(
          "dropped strokes",
          fmt::format("{} beyond --undo-memory{}", back.dropped,
                      back.tooLarge ? fmt::format("; {} larger than the whole memory", back.tooLarge) : std::string()));
  }
  if (report.recorded)
    rows.print("recorded forces",
               fmt::format("differ by {:.3g} N rms, at most {:.3g} N, over {}", report.recorded->rms_N,
                           report.recorded->worst_N, counted(report.recorded->ticks, "tick")));
  if (report.log) {
    const LogReport& log = *report.log;
    rows.print("session log", fmt::format("{} bytes, {:.1f} a tick", log.bytes,
                                          static_cast<double>(log.bytes) /
                                              static_cast<double>(std::max<std::uint64_t>(1, trace.ticks))));
    if (log.lostTicks + log.mergedEdits)
      rows.print("log behind", fmt::format("{} ticks are missing in it; {} superseded by later ones of the same points",
                                           log.lostTicks, counted(log.mergedEdits, "edit")));
  }
}

void printShortfalls(const Rows& rows, const TouchReport& report) {
  const TouchShortfalls& shortfalls = report.shortfalls;
  if (shortfalls.editsTooSlow)
    rows.print("dropped edits",
               fmt::format("{} (an edit takes longer than a force can be held)", shortfalls.editsTooSlow));
  if (shortfalls.pathsDropped)
    rows.print("unfinished strokes",
               fmt::format("{} (the hand was too far ahead of the points under the brush)", shortfalls.pathsDropped));
  if (shortfalls.editsLogFull)
    rows.print("dropped edits", fmt::format("{} (edit log full, a reader fell behind)", shortfalls.editsLogFull));
  if (shortfalls.editsHeldUp)
    rows.print("dropped edits", fmt::format("{} (the index was being compacted)", shortfalls.editsHeldUp));
  if (report.edits)
    rows.print("index", fmt::format("{}: followed {}, rebuilt {} times, {} for edits that it could not follow; "
                                    "compacted {} times in the background",
                                    nameOf(report.index), counted(report.index.followed, "edit"), report.index.built,
                                    shortfalls.editsRebuilt, report.compactions));
  if (shortfalls.thinnedTicks)
    rows.print("subsampled ticks",
               fmt::format("{}: more points near the probe than a tick visits", shortfalls.thinnedTicks));
  if (shortfalls.truncatedTicks)
    rows.print("unfinished ticks", fmt::format("{}: the proxy had not converged when the work budget was spent",
                                               shortfalls.truncatedTicks));
}

}  // namespace

void printReport(std::FILE* out, const TouchReport& report) {
  const Rows rows(out, report);
  printParticipants(rows, report);
  printModel(rows, report);
  printTicks(rows, report);
  printForces(rows, report);
  printTimes(rows, report);
  printLimits(rows, report);
  printStrokes(rows, report);
  printShortfalls(rows, report);
}

}  // namespace palpate
