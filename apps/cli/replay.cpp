#include "apps/cli/context.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/results.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/session_replay.hpp"

namespace palpate {

namespace {

struct ReplayOptions {
  std::string log, model, saveFile, traceFile;
  bool recover = false;
  double tolerance = 0;
};

void print(std::FILE* out, const Recorded& recorded, const ReplayOutcome* outcome, const std::string& machine) {
  const auto row = [&](std::string_view what, const std::string& value) { fmt::print(out, "{:<22}{}\n", what, value); };
  const SessionRecord& record = recorded.record;
  row("session",
      fmt::format("{}, {} of points, {}", counted(record.ticks.size(), "tick"),
                  counted(record.edits.points.size(), "edit"), record.end ? "to its end" : "not to its end"));
  for (const std::string& sentence : whatIsMissing(record)) row("missing in the log", sentence);
  if (record.end && record.end->lostTicks)
    row("missing in the log", fmt::format("{}: its thread had fallen behind", counted(record.end->lostTicks, "tick")));
  if (record.mergedEdits)
    row("merged in the log",
        fmt::format("{} that others of the same point followed", counted(record.mergedEdits, "edit")));
  row("recorded on", recorded.session.machine);
  if (recorded.endsAsRecorded)
    row("recorded edits", *recorded.endsAsRecorded ? "give the recorded points"
                          : record.gaps.empty()    ? "do NOT give the recorded points"
                                                   : "do not give the recorded points: some are missing");
  if (!outcome) return;
  const Differences& found = outcome->differences;
  row("run again on", machine);
  row("ticks compared", fmt::format("{}{}", found.ticks,
                                    outcome->comparable.because.empty()
                                        ? std::string()
                                        : fmt::format(" of {}; the session cannot be run again exactly: {}",
                                                      record.ticks.size(), outcome->comparable.because)));
  row("force", fmt::format("{} ticks differ, by {} N at most", found.forceTicks, found.largestForce_N));
  row("edits", fmt::format("{} ticks differ", found.editTicks));
  row("points in the end",
      found.ends ? fmt::format("{} differ", found.points) : "not compared: " + reasonOf(*outcome, recorded));
  if (found.attributes > 0) row("masks and fields", fmt::format("{} differ", found.attributes));
  if (found.first_s) row("first difference", fmt::format("{:.3f} s", *found.first_s));
}

struct Replayed {
  const Recorded& recorded;
  const ReplayOutcome* outcome = nullptr;  ///< null: only the edits were applied

  const SessionRecord& record() const { return recorded.record; }
};

using Value = std::optional<Json>;

constexpr Reported<LogGap> kGaps[]{
    {"begin_byte", "B", "first byte that cannot be read", [](const LogGap& g) -> Value { return g.begin; }},
    {"end_byte", "B", "byte behind the last one", [](const LogGap& g) -> Value { return g.end; }},
    {"ticks_before", "", "ticks before the gap", [](const LogGap& g) -> Value { return g.tick; }},
    {"ticks", "", "missing ticks; null: unknown", [](const LogGap& g) -> Value { return orNull(g.ticks); }},
    {"edits", "", "missing edits; null: unknown", [](const LogGap& g) -> Value { return orNull(g.states); }},
};

template <class T>
Value compared(const Replayed& r, T Differences::*member) {
  return r.outcome ? Value(r.outcome->differences.*member) : std::nullopt;
}

constexpr Reported<Replayed> kReplay[]{
    {"ticks", "", "ticks in the log", [](const Replayed& r) -> Value { return r.record().ticks.size(); }},
    {"edits", "", "edits of points in the log",
     [](const Replayed& r) -> Value { return r.record().edits.points.size(); }},
    {"points", "", "points of the model", [](const Replayed& r) -> Value { return r.recorded.session.points; }},
    {"whole_bytes", "B", "size up to the last complete block",
     [](const Replayed& r) -> Value { return r.record().wholeBytes; }},
    {"file_bytes", "B", "size of the file", [](const Replayed& r) -> Value { return r.record().fileBytes; }},
    {"ended", "", "whether the log contains the end of the session",
     [](const Replayed& r) -> Value { return r.record().end.has_value(); }},
    {"gaps", "", "parts of the log that are missing",
     [](const Replayed& r) -> Value {
       Json gaps = Json::array();
       for (const LogGap& gap : r.record().gaps) gaps.push_back(jsonBy(kGaps, gap));
       return gaps;
     }},
    {"merged_edits", "", "edits superseded by later ones of the same points",
     [](const Replayed& r) -> Value { return r.record().mergedEdits; }},
    {"lost_ticks", "", "ticks missing, as the log's thread had fallen behind",
     [](const Replayed& r) -> Value { return r.record().end ? r.record().end->lostTicks : 0; }},
    {"ends_as_recorded", "", "whether the recorded edits give the recorded final points; null: unknown",
     [](const Replayed& r) -> Value { return orNull(r.recorded.endsAsRecorded); }},
    {"compared_ticks", "", "ticks compared", [](const Replayed& r) { return compared(r, &Differences::ticks); }},
    {"reason", "", "why later ticks, or the points at the end, are not compared; empty: all are",
     [](const Replayed& r) -> Value { return r.outcome ? Value(reasonOf(*r.outcome, r.recorded)) : std::nullopt; }},
    {"force_ticks", "", "ticks with another force",
     [](const Replayed& r) { return compared(r, &Differences::forceTicks); }},
    {"largest_force_N", "N", "largest difference of the force",
     [](const Replayed& r) { return compared(r, &Differences::largestForce_N); }},
    {"edit_ticks", "", "ticks with other edits",
     [](const Replayed& r) { return compared(r, &Differences::editTicks); }},
    {"end_points", "", "points that differ in the end; null: not compared",
     [](const Replayed& r) -> Value {
       if (!r.outcome) return std::nullopt;
       return r.outcome->differences.ends ? Json(r.outcome->differences.points) : Json(nullptr);
     }},
    {"end_attributes", "", "masks and fields that differ in the end; null: not compared",
     [](const Replayed& r) -> Value {
       if (!r.outcome) return std::nullopt;
       return r.outcome->differences.ends ? Json(r.outcome->differences.attributes) : Json(nullptr);
     }},
    {"first_difference_s", "s", "time of the first difference; null: none",
     [](const Replayed& r) -> Value {
       return r.outcome ? Value(orNull(r.outcome->differences.first_s)) : std::nullopt;
     }},
};

void replay(Context& context, const ReplayOptions& options) {
  if (options.recover && options.saveFile.empty()) throw UsageError("--recover: needs --save OUT.ply");
  if (!options.recover && !options.saveFile.empty()) throw UsageError("--save: needs --recover");
  if (options.recover && !options.traceFile.empty())
    throw UsageError("--trace: has no effect with --recover, which runs nothing; leave one of them out");
  checkOutput(options.saveFile, Output::points);
  checkOutput(options.traceFile, Output::only);
  sayWhatIsLost(options.saveFile, context.log());
  const ReplayParts parts{.backends = context.backends(),
                          .log = context.log(),
                          .threads = context.threads(),
                          .model = options.model,
                          .naming = "--model"};
  Recorded recorded = loadRecorded(options.log, parts);
  std::optional<ReplayOutcome> outcome;
  std::string machine;
  if (options.recover) {
    saveKeeping(options.saveFile, editedCloud(recorded.model.cloud, recorded.points, recorded.attributes.fields()));
    context.log().say("{}: the points after the recorded edits are saved", options.saveFile);
  } else {
    const SessionAgain again = runAgain(recorded, parts);
    if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, again.result.trace());
    outcome = compareRuns(recorded, again, options.tolerance);
    machine = context.backends().named(recorded.session.config.backend.name).machine(context.threads());
  }
  print(context.tables(), recorded, outcome ? &*outcome : nullptr, machine);
  context.writeJson(jsonBy(kReplay, Replayed{recorded, outcome ? &*outcome : nullptr}));
  if (recorded.endsAsRecorded == false && recorded.record.gaps.empty())
    throw FileError(options.log, "the recorded edits do not give the final points of the session");
  if (outcome && outcome->differences.any())
    throw FileError(options.log, "the replay differs from the recording; see above");
}

}  // namespace

void listReplayResults(std::vector<ResultFacts>& all) {
  listResults(all, "replay", "", kReplay);
  listResults(all, "replay", "gaps[].", kGaps);
}

void addReplay(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "replay", "replay a recorded session in virtual time and compare forces and points tick by tick");
  auto options = std::make_shared<ReplayOptions>();
  sub.add("log", options->log,
          "log written by palpate touch --log; a truncated or damaged one is read as far as it is intact, and the rest "
          "is reported as missing")
      .required()
      .typeName("LOG");
  sub.add("--model", options->model, "model of the session (default: the file named in the log)").typeName("MODEL");
  sub.add("--tolerance", options->tolerance,
          "differences up to this are ignored: N for forces, mm for points (0: bit-identical)")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
  sub.addFlag("--recover", options->recover,
              "do not run the session: only apply its recorded edits, and --save the points");
  sub.add("--save", options->saveFile, "points after the recorded edits").typeName("OUT.ply").writes(Writes::keeping);
  sub.add("--trace", options->traceFile, "trace of the replayed session, one row per tick")
      .typeName("FILE.csv")
      .writes(Writes::replacing);
  sub.footer(
      "A session recorded against the wall clock can only be reproduced up to its first late "
      "answer; from there on, and where edits were applied in order of arrival, forces are not "
      "compared, and the report says so. The recorded edits are always compared with the recorded "
      "final points.\n"
      "Exit code 1 when any difference exceeds the tolerance, or when the edits of a whole log do not give the "
      "recorded "
      "final points. What a truncated or damaged log lacks is reported, and is not a difference.\n");
  sub.whenNamed([&, options] { command = [&context, options] { replay(context, *options); }; });
}

}  // namespace palpate
