// The JSON of a touch session: a row for each key.
#include "apps/cli/touch_results.hpp"

#include "apps/cli/sharing_results.hpp"
#include "apps/cli/tick_times.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

using Value = std::optional<Json>;

Json summary(const Summary& s) { return {{"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}}; }

constexpr Reported<GateCounts> kSafety[]{
    {"errors", "", "times that an error closed the gate, with zero force",
     [](const GateCounts& g) -> Value { return g.errors; }},
    {"stale_ticks", "", "ticks with reduced force, as its data were old",
     [](const GateCounts& g) -> Value { return g.stale; }},
    {"aged_ticks", "", "ticks with reduced force, as the server was silent",
     [](const GateCounts& g) -> Value { return g.aged; }},
    {"hot_ticks", "", "ticks with reduced force, to spare hot motors",
     [](const GateCounts& g) -> Value { return g.hot; }},
};

constexpr Reported<FurtherHandReport> kFurtherHands[]{
    {"device", "", "its device", [](const FurtherHandReport& s) -> Value { return s.device; }},
    {"ticks", "", "ticks of the session", [](const FurtherHandReport& s) -> Value { return s.trace.ticks; }},
    {"contact_ticks", "", "ticks in contact", [](const FurtherHandReport& s) -> Value { return s.trace.contactTicks; }},
    {"fresh_fraction", "1", "fraction of ticks answered in time",
     [](const FurtherHandReport& s) -> Value { return s.trace.freshFraction; }},
    {"peak_force_N", "N", "largest force", [](const FurtherHandReport& s) -> Value { return s.trace.peakForce_N; }},
    {"passivity_energy_mJ", "mJ", "smallest energy that the surface had taken in; null: not observed",
     [](const FurtherHandReport& s) -> Value { return orNull(s.counts.leastEnergy_mJ); }},
    {"safety", "", "reduced force, as for the first hand",
     [](const FurtherHandReport& s) -> Value { return jsonBy(kSafety, s.counts.withheld); }},
};

constexpr Reported<PlayCounts> kFrames[]{
    {"played", "", "frames played", [](const PlayCounts& f) -> Value { return f.played; }},
    {"lost", "", "frames that could not be read", [](const PlayCounts& f) -> Value { return f.lost; }},
    {"dropped", "", "frames dropped, as a newer one had arrived",
     [](const PlayCounts& f) -> Value { return f.dropped; }},
    {"last_loss", "", "reason of the last loss", [](const PlayCounts& f) -> Value { return f.lastLoss; }},
    {"silent_since_s", "s", "time of the last frame, if no more arrived; else null",
     [](const PlayCounts& f) -> Value { return orNull(f.silentSince_s); }},
};

constexpr Reported<PortEnergy> kPorts[]{
    {"energy_mJ", "mJ", "energy that the hand has put in", [](const PortEnergy& p) -> Value { return 1e3 * p.now_J; }},
    {"min_energy_mJ", "mJ", "its minimum", [](const PortEnergy& p) -> Value { return 1e3 * p.min_J; }},
};

constexpr Reported<MatterReport> kMatter[]{
    {"kind", "", "water, sand or soft", [](const MatterReport& m) -> Value { return m.scene.matter; }},
    {"substeps", "", "substeps per millisecond", [](const MatterReport& m) -> Value { return m.scene.substeps; }},
    {"gain", "1", "ratio of the felt force to the simulated one",
     [](const MatterReport& m) -> Value { return m.scene.gain; }},
    {"coupling_N_mm", "N/mm", "stiffness of the spring between hand and ball; null: a soft body",
     [](const MatterReport& m) -> Value {
       return m.scene.coupling_N_mm > 0 ? Json(m.scene.coupling_N_mm) : Json(nullptr);
     }},
    {"elasticity", "", "of a soft body, in words; else null",
     [](const MatterReport& m) -> Value {
       return m.scene.elasticity.empty() ? Json(nullptr) : Json(m.scene.elasticity);
     }},
    {"dropped_s", "s", "time dropped, as the simulation fell behind the clock",
     [](const MatterReport& m) -> Value { return m.dropped_s; }},
    {"advances", "", "advances of the simulation, each of some milliseconds",
     [](const MatterReport& m) -> Value { return m.advances; }},
    {"kept_ticks", "", "ticks in which the surface was held by the position that the hand pressed on",
     [](const MatterReport& m) -> Value { return m.holds.keptTicks; }},
    {"gave_way_ticks", "", "of these, ticks in which the body could not bear it and yielded evenly",
     [](const MatterReport& m) -> Value { return m.holds.gaveWayTicks; }},
    {"ports", "", "energy of each hand",
     [](const MatterReport& m) -> Value {
       Json ports = Json::array();
       for (const PortEnergy& port : m.ports) ports.push_back(jsonBy(kPorts, port));
       return ports;
     }},
};

constexpr Reported<UndoneStrokes> kUndo[]{
    {"strokes", "", "strokes made", [](const UndoneStrokes& u) -> Value { return u.strokes; }},
    {"undone", "", "strokes undone", [](const UndoneStrokes& u) -> Value { return u.undone; }},
    {"redone", "", "strokes redone", [](const UndoneStrokes& u) -> Value { return u.redone; }},
    {"forgotten", "", "strokes dropped beyond --undo-memory",
     [](const UndoneStrokes& u) -> Value { return u.dropped; }},
    {"too_large", "", "of them, larger than the whole memory",
     [](const UndoneStrokes& u) -> Value { return u.tooLarge; }},
};

constexpr Reported<ForceDifference> kRecorded[]{
    {"ticks", "", "ticks compared", [](const ForceDifference& d) -> Value { return d.ticks; }},
    {"rms_N", "N", "root mean square of the difference", [](const ForceDifference& d) -> Value { return d.rms_N; }},
    {"worst_N", "N", "largest difference", [](const ForceDifference& d) -> Value { return d.worst_N; }},
};

constexpr Reported<LogReport> kLog[]{
    {"bytes", "B", "size of the log", [](const LogReport& l) -> Value { return l.bytes; }},
    {"lost_ticks", "", "ticks missing in it, as its thread had fallen behind",
     [](const LogReport& l) -> Value { return l.lostTicks; }},
    {"merged_edits", "", "edits superseded by later ones of the same points",
     [](const LogReport& l) -> Value { return l.mergedEdits; }},
};

constexpr Reported<RosHand::Counts> kRos[]{
    {"ticks", "", "ticks published", [](const RosHand::Counts& r) -> Value { return r.ticks; }},
    {"lost", "", "ticks dropped, as the queue was full", [](const RosHand::Counts& r) -> Value { return r.lost; }},
};

constexpr Reported<ServerSave> kServerSave[]{
    {"written", "", "whether the server has written its file (palpate serve --save)", field<&ServerSave::written>},
    {"points", "", "points in it", field<&ServerSave::points>},
    {"words", "", "its name at the server, or why it was not written", field<&ServerSave::words>},
};

bool hasBall(const TouchReport& r) { return r.matter && r.matter->scene.coupling_N_mm > 0; }

constexpr Reported<TouchReport> kTouch[]{
    {"points", "", "points of the model", [](const TouchReport& r) -> Value { return r.points; }},
    {"ticks", "", "ticks of the session", [](const TouchReport& r) -> Value { return r.trace.ticks; }},
    {"contact_ticks", "", "ticks in contact", [](const TouchReport& r) -> Value { return r.trace.contactTicks; }},
    {"step_us", "us", "time from pose read to force ready",
     [](const TouchReport& r) -> Value { return summary(r.trace.step_us); }},
    {"gpu_us", "us", "time of a tick on the GPU",
     [](const TouchReport& r) -> Value { return summary(r.trace.gpu_us); }},
    {"build_us", "us", "build of the index", [](const TouchReport& r) -> Value { return r.build_us; }},
    {"start_s", "s", "stages from the beginning to the first answer, by name",
     [](const TouchReport& r) -> Value {
       Json stages = Json::object();
       for (const StartStage& stage : r.start) stages[stage.name] = stage.time_s;
       return stages;
     }},
    {"fresh_fraction", "1", "fraction of ticks answered in time",
     [](const TouchReport& r) -> Value { return r.trace.freshFraction; }},
    {"peak_force_N", "N", "largest force", [](const TouchReport& r) -> Value { return r.trace.peakForce_N; }},
    {"stiffness_N_per_mm", "N/mm", "stiffness of the contact that the session asked for",
     [](const TouchReport& r) -> Value { return r.stiffness_N_per_mm; }},
    {"remembered", "", "what is remembered for the device, in words; empty: nothing",
     [](const TouchReport& r) -> Value { return r.remembered; }},
    {"moved_points", "", "points that edits have changed", [](const TouchReport& r) -> Value { return r.movedPoints; }},
    {"blocked_moves", "",
     "moves for which points had no room, before a side that stays; in each edit one for each point",
     [](const TouchReport& r) -> Value { return r.blocked.moves; }},
    {"blocked_edits", "", "edits in which nearly all points under the brush had no room",
     [](const TouchReport& r) -> Value { return r.blocked.edits; }},
    {"edits_from_behind", "",
     "edits without an effect, or ticks with the button pressed, since the hand was behind the surface",
     [](const TouchReport& r) -> Value { return r.blocked.fromBehind; }},
    {"backend", "", "back end that answered", [](const TouchReport& r) -> Value { return r.backend; }},
    {"gpu", "", "name of the machine that answered", [](const TouchReport& r) -> Value { return r.machine; }},
    {"method", "", "method of the neighbour search", [](const TouchReport& r) -> Value { return r.method; }},
    {"index", "", "static, incremental, rebuild, or incremental and rebuild",
     [](const TouchReport& r) -> Value { return nameOf(r.index); }},
    {"index_followed", "", "edits that the index followed",
     [](const TouchReport& r) -> Value { return r.index.followed; }},
    {"index_rebuilds", "", "rebuilds of the index", [](const TouchReport& r) -> Value { return r.index.built; }},
    {"contact_error_mm", "mm", "largest distance of the proxy from the surface in double precision; null: not computed",
     [](const TouchReport& r) -> Value {
       return r.error.ticks > r.error.undefined ? Json(r.error.worst_mm) : Json(nullptr);
     }},
    {"contact_error_undefined", "", "compared ticks without a surface in double precision",
     [](const TouchReport& r) -> Value { return r.error.undefined; }},
    {"missed_ticks", "", "ticks skipped because their time had passed",
     [](const TouchReport& r) -> Value { return r.trace.missedTicks; }},
    {"tick_histogram_us", "us", "histogram of step times: lower ends of bins, ticks in each, bins per octave",
     [](const TouchReport& r) -> Value { return toJson(r.servo.step_us); }},
    {"late_histogram_us", "us", "histogram of wake-up latencies, likewise",
     [](const TouchReport& r) -> Value { return toJson(r.servo.late_us); }},
    {"servo_thread", "", "preemptions, time without a core (us) and page faults of the servo thread",
     [](const TouchReport& r) -> Value { return toJson(r.servo.scheduling); }},
    {"passivity_energy_mJ", "mJ", "smallest energy that the surface had taken in; null: not observed",
     [](const TouchReport& r) -> Value { return orNull(r.servo.leastEnergy_mJ); }},
    {"safety", "", "reduced force", [](const TouchReport& r) -> Value { return jsonBy(kSafety, r.servo.withheld); }},
    {"interrupted", "", "whether a signal ended the session",
     [](const TouchReport& r) -> Value { return r.interrupted; }},
    {"dropped_edits", "", "dropped edits",
     [](const TouchReport& r) -> Value {
       return r.shortfalls.editsLogFull + r.shortfalls.editsTooSlow + r.shortfalls.editsHeldUp;
     }},
    {"compactions", "", "compactions of the index in the background",
     [](const TouchReport& r) -> Value { return r.compactions; }},
    {"edits_with_rebuild", "", "edits for which the index was rebuilt",
     [](const TouchReport& r) -> Value { return r.shortfalls.editsRebuilt; }},
    {"thinned_ticks", "", "ticks in which neighbours were subsampled",
     [](const TouchReport& r) -> Value { return r.shortfalls.thinnedTicks; }},
    {"thinned_patches", "", "patches for late answers whose points were subsampled",
     [](const TouchReport& r) -> Value { return r.shortfalls.thinnedPatches; }},
    {"truncated_ticks", "", "ticks in which the proxy had not converged within the work budget",
     [](const TouchReport& r) -> Value { return r.shortfalls.truncatedTicks; }},
    {"matter", "", "simulated matter; else null",
     [](const TouchReport& r) -> Value { return r.matter ? jsonBy(kMatter, *r.matter) : Json(nullptr); }},
    {"shape_strokes", "", "strokes that changed the rest shape of a soft body; else null",
     [](const TouchReport& r) -> Value { return r.shape ? Json(r.shape->strokes) : Json(nullptr); }},
    {"radius_mm", "mm", "support radius", [](const TouchReport& r) -> Value { return r.radius_mm; }},
    {"cell_mm", "mm", "edge of a cell of the index", [](const TouchReport& r) -> Value { return r.cell_mm; }},
    {"spacing_mm", "mm", "mean distance of neighbouring points",
     [](const TouchReport& r) -> Value { return r.spacing_mm; }},
    {"noise_spacings", "spacings", "noise of the points",
     [](const TouchReport& r) -> Value { return r.noise_spacings; }},
    {"mm_per_unit", "mm", "touch scale: millimetres in the hand per model unit",
     [](const TouchReport& r) -> Value { return r.mm_per_unit; }},
    {"tool", "", "with a tool of many points: its kind",
     [](const TouchReport& r) -> Value { return r.toolPoints ? Value(r.tool) : std::nullopt; }},
    {"tool_points", "", "with a tool of many points: their number",
     [](const TouchReport& r) -> Value { return r.toolPoints ? Value(r.toolPoints) : std::nullopt; }},
    {"peak_torque_mNm", "mN m", "largest torque of a tool of many points about the HIP, or of a ball in matter",
     [](const TouchReport& r) -> Value {
       return r.toolPoints || hasBall(r) ? Value(r.trace.peakTorque_mNm) : std::nullopt;
     }},
    {"frames", "", "frames of a depth camera", [](const TouchReport& r) -> Value { return partBy(kFrames, r.frames); }},
    {"ros", "", "publishing to ROS 2", [](const TouchReport& r) -> Value { return partBy(kRos, r.ros); }},
    {"shared", "", "exchange with the other participants of a joined session",
     [](const TouchReport& r) -> Value { return r.shared ? Value(toJson(*r.shared)) : std::nullopt; }},
    {"server_save", "", "answer of the server to --save",
     [](const TouchReport& r) -> Value { return partBy(kServerSave, r.atServer); }},
    {"cameras", "", "cameras of the other participants at the end",
     [](const TouchReport& r) -> Value { return r.cameras ? Value(*r.cameras) : std::nullopt; }},
    {"other_hands", "", "hands of the other participants at the end",
     [](const TouchReport& r) -> Value { return r.cameras ? Value(toJson(r.others)) : std::nullopt; }},
    {"partial", "", "points streamed around the hand (--partial)",
     [](const TouchReport& r) -> Value { return r.far ? Value(toJson(*r.far)) : std::nullopt; }},
    {"hands", "", "the hands after the first (--hand)",
     [](const TouchReport& r) -> Value {
       Json hands = Json::array();
       for (const FurtherHandReport& hand : r.hands) hands.push_back(jsonBy(kFurtherHands, hand));
       return r.hands.empty() ? std::nullopt : Value(hands);
     }},
    {"bridge_us", "us", "time of forces computed from the last patch of points, for late answers",
     [](const TouchReport& r) -> Value { return r.bridge_us.count ? Value(summary(r.bridge_us)) : std::nullopt; }},
    {"undo", "", "strokes undone (--undo)", [](const TouchReport& r) -> Value { return partBy(kUndo, r.back); }},
    {"recorded_forces", "", "difference from the forces of the replayed recording",
     [](const TouchReport& r) -> Value { return partBy(kRecorded, r.recorded); }},
    {"log", "", "the session log (--log)", [](const TouchReport& r) -> Value { return partBy(kLog, r.log); }},
    {"edit_us", "us", "time of a tick that edits",
     [](const TouchReport& r) -> Value { return r.edits ? Value(summary(r.edit_us)) : std::nullopt; }},
    {"edit_ticks", "", "number of these ticks",
     [](const TouchReport& r) -> Value { return r.edits ? Value(r.edit_us.count) : std::nullopt; }},
};

}  // namespace

Json toJson(const TouchReport& report) { return jsonBy(kTouch, report); }

void listTouchResults(std::vector<ResultFacts>& all) {
  const auto list = [&](std::string_view before, const auto& rows) { listResults(all, "touch", before, rows); };
  list("", kTouch);
  list("safety.", kSafety);
  list("matter.", kMatter);
  list("matter.ports[].", kPorts);
  list("frames.", kFrames);
  list("ros.", kRos);
  listSharingResults(all, "touch");
  list("hands[].", kFurtherHands);
  list("server_save.", kServerSave);
  list("undo.", kUndo);
  list("recorded_forces.", kRecorded);
  list("log.", kLog);
}

}  // namespace palpate
