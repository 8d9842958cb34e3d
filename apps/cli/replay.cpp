#include "apps/cli/context.hpp"
#include "apps/cli/output.hpp"
#include "engine/cloud/edited_cloud.hpp"
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
  row("session", fmt::format("{} ticks, {} edits of points, {}", record.ticks.size(), record.edits.points.size(),
                             record.end ? "to its end" : "not to its end"));
  for (const std::string& sentence : whatIsMissing(record)) row("missing in the log", sentence);
  if (record.end && record.end->lostTicks)
    row("missing in the log", fmt::format("{} ticks: its thread had fallen behind", record.end->lostTicks));
  if (record.mergedEdits)
    row("merged in the log", fmt::format("{} edits that others of the same point followed", record.mergedEdits));
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
  row("points in the end", found.ends ? fmt::format("{} differ", found.points) : "not compared");
  if (found.first_s) row("first difference", fmt::format("{:.3f} s", *found.first_s));
}

Json toJson(const LogGap& gap) {
  const auto count = [](const std::optional<std::uint64_t>& missing) {
    return missing ? Json(*missing) : Json(nullptr);
  };
  return {{"begin_byte", gap.begin},
          {"end_byte", gap.end},
          {"ticks_before", gap.tick},
          {"ticks", count(gap.ticks)},
          {"edits", count(gap.states)}};
}

Json toJson(const Recorded& recorded, const ReplayOutcome* outcome) {
  const SessionRecord& record = recorded.record;
  Json gaps = Json::array();
  for (const LogGap& gap : record.gaps) gaps.push_back(toJson(gap));
  Json json{{"ticks", record.ticks.size()},
            {"edits", record.edits.points.size()},
            {"points", recorded.session.points},
            {"whole_bytes", record.wholeBytes},
            {"file_bytes", record.fileBytes},
            {"ended", record.end.has_value()},
            {"gaps", std::move(gaps)},
            {"merged_edits", record.mergedEdits},
            {"lost_ticks", record.end ? record.end->lostTicks : 0},
            {"ends_as_recorded", recorded.endsAsRecorded ? Json(*recorded.endsAsRecorded) : Json(nullptr)}};
  if (!outcome) return json;
  const Differences& found = outcome->differences;
  json["compared_ticks"] = found.ticks;
  json["not_compared_because"] = outcome->comparable.because;
  json["force_ticks"] = found.forceTicks;
  json["largest_force_N"] = found.largestForce_N;
  json["edit_ticks"] = found.editTicks;
  json["end_points"] = found.ends ? Json(found.points) : Json(nullptr);
  json["first_difference_s"] = found.first_s ? Json(*found.first_s) : Json(nullptr);
  return json;
}

void replay(Context& context, const ReplayOptions& options) {
  if (options.recover && options.saveFile.empty()) throw UsageError("--recover: needs --save OUT.ply");
  if (!options.recover && !options.saveFile.empty()) throw UsageError("--save: needs --recover");
  if (options.recover && !options.traceFile.empty()) throw UsageError("--trace: --recover runs nothing");
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
    saveKeeping(options.saveFile, editedCloud(recorded.model.cloud, recorded.points));
  } else {
    const SessionAgain again = runAgain(recorded, parts);
    if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, again.result.trace());
    outcome = compareRuns(recorded, again, options.tolerance);
    machine = context.backends().named(recorded.session.config.backend.name).machine(context.threads());
  }
  print(context.tables(), recorded, outcome ? &*outcome : nullptr, machine);
  context.writeJson(toJson(recorded, outcome ? &*outcome : nullptr));
  if (recorded.endsAsRecorded == false && recorded.record.gaps.empty())
    throw FileError(options.log, "its edits do not give the points that the session ended with");
  if (outcome && outcome->differences.any())
    throw FileError(options.log, "the session did not come out the same; see above");
}

}  // namespace

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
  sub.add("--save", options->saveFile, "points after the recorded edits").typeName("OUT.ply");
  sub.add("--trace", options->traceFile, "trace of the replayed session, one row per tick").typeName("FILE.csv");
  sub.footer(
      "A session recorded against the wall clock can only be reproduced up to its first late "
      "answer; from there on, and where edits were applied in order of arrival, forces are not "
      "compared, and the report says so. The recorded edits are always compared with the recorded "
      "final points.\n"
      "Exit code 1 when any difference exceeds the tolerance.\n");
  sub.whenNamed([&, options] { command = [&context, options] { replay(context, *options); }; });
}

}  // namespace palpate
