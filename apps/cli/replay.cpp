#include "apps/cli/context.hpp"
#include "apps/cli/replay_comparison.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/saving.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

namespace {

struct ReplayOptions {
  std::string log, model, saveFile, traceFile;
  bool recover = false;
  double tolerance = 0;
};

/// A log, the model that it is about, until a session takes it, and the points as its edits leave them.
struct Recorded {
  SessionRecord record;
  RecordedSession session;
  Model model;
  ModelScale scale;
  std::vector<PointState> points;
  std::optional<bool> endsAsRecorded;  ///< nothing where the session did not come to its end
};

// States that a log lacks, as far as it is known: no more than its gaps have room for, or say.
std::uint64_t mostMissingEdits(const SessionRecord& record) {
  std::uint64_t most = 0;
  for (const LogGap& gap : record.gaps) most += gap.states.value_or((gap.end - gap.begin) / sizeof(PointState));
  return most;
}

// What a log of edits may do to the points: sets them, and adds some behind them.
std::vector<PointState> edited(const ReplayOptions& options, const Model& model, const SessionRecord& record) {
  const EditBatch& edits = record.edits;
  const std::size_t most = model.cloud.size() + edits.points.size() + mostMissingEdits(record);
  for (const PointState& state : edits.points)
    if (state.number() >= most || state.parent >= most)
      throw FileError(options.log, fmt::format("names the point {}, and with all its edits there are {}; it is damaged",
                                               std::max(state.number(), state.parent), most));
  Journal journal(model.cloud);
  journal.follow(edits);
  return {journal.points().begin(), journal.points().end()};
}

Recorded load(Context& context, const ReplayOptions& options) {
  Recorded recorded{.record = readSessionLog(options.log)};
  recorded.session = parseHeader(options.log, recorded.record.text);
  const SessionRecord& record = recorded.record;
  SessionConfig& config = recorded.session.config;
  ModelConfig& model = config.model;
  if (!options.model.empty()) model.file = options.model;
  if (!config.matter && !std::filesystem::exists(model.file))
    throw FileError(model.file, "is not there; name the model of the session with --model");
  const BackendKind& kind = context.backends().named(config.backend.name);
  recorded.model =
      loadModel(config, {.log = context.log(), .threads = context.threads(), .estimate = kind.normalEstimator()});
  recorded.scale = recorded.model.scale;
  if (recorded.model.cloud.size() != recorded.session.points)
    throw FileError(model.file, fmt::format("has {} points, and that of the session had {}; name the right model with "
                                            "--model",
                                            recorded.model.cloud.size(), recorded.session.points));
  if (checksumOf(recorded.model) != recorded.session.checksum)
    throw FileError(model.file,
                    "has changed since the session: its points are others; name the right model with "
                    "--model");
  const auto falls = [](const LoggedTick& a, const LoggedTick& b) { return !(a.time_s < b.time_s); };
  if (std::ranges::adjacent_find(record.ticks, falls) != record.ticks.end())
    throw FileError(options.log, "its ticks do not follow one another in time; it is damaged");
  recorded.points = edited(options, recorded.model, record);
  if (record.end)
    recorded.endsAsRecorded = checksumOf(recorded.model.cloud.origin, recorded.points) == record.end->points;
  return recorded;
}

/// The session run again in virtual time.
struct Again {
  ServoResult result;
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  std::vector<PointState> points;
};

/// Keeps all that was done to the points.
class EditCollector final : public EditFollower {
 public:
  explicit EditCollector(EditBatch& all) : all_(all) {}
  void catchUp(const EditBatch& batch) override {
    const std::size_t before = all_.points.size();
    all_.points.insert(all_.points.end(), batch.points.begin(), batch.points.end());
    for (const EditMark& mark : batch.marks) all_.marks.push_back({before + mark.at, mark.kind});
  }

 private:
  EditBatch& all_;
};

Again runAgain(Context& context, Recorded& recorded) {
  const SessionRecord& record = recorded.record;
  SessionConfig config = recorded.session.config;
  config.realtime = false;
  config.hands = {HandConfig{}};
  config.duration_s = 0;  // as long as the recording
  Again again;
  Session session(config, std::move(recorded.model),
                  {.backend = context.backends().named(config.backend.name),
                   .threads = context.threads(),
                   .journal = true,
                   .undo_bytes = undoBytes(config.undo),
                   .log = &context.log(),
                   .follower = [&](const Model&, TouchBackend&) { return std::make_unique<EditCollector>(again.edits); }});
  ReplayDevice device(record.ticks, recorded.session.limits);
  TickTap tap(session.backend(), [&](const LoggedTick& tick) { again.ticks.push_back(tick); });
  const OpenHand hand{.device = &device,
                         .map = recorded.session.map,
                         .duration_s = record.ticks.back().time_s,
                         .passivity = recorded.session.passivity};
  again.result = session.run({&hand, 1}, {.recorder = &tap});
  session.finish();
  if (record.end) session.undo(config.undo.undo, config.undo.redo);
  session.checkFollower();
  again.points.assign(session.journal()->points().begin(), session.journal()->points().end());
  return again;
}

struct Outcome {
  ComparableTicks comparable;
  Differences differences;
};

Outcome compare(const Recorded& recorded, const Again& again, double tolerance) {
  const SessionConfig& config = recorded.session.config;
  const bool ordered = config.backend.name == "cpu" || config.backend.deterministic;
  const Tolerance allowed{tolerance, recorded.scale};
  Outcome outcome{.comparable = comparableTicks(recorded.record, config.rate_Hz, config.realtime, ordered)};
  if (config.realtime && config.moves())
    outcome.comparable = {0, "in real time the frames of a model that moves come when they are ready"};
  outcome.differences = compareTicks({recorded.record.ticks, &recorded.record.edits}, {again.ticks, &again.edits},
                                     outcome.comparable.count, allowed);
  outcome.differences.ends =
      recorded.record.end && recorded.record.gaps.empty() && outcome.comparable.count == recorded.record.ticks.size();
  if (outcome.differences.ends) outcome.differences.points = differingPoints(recorded.points, again.points, allowed);
  return outcome;
}

void print(std::FILE* out, const Recorded& recorded, const Outcome* outcome, const std::string& machine) {
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

Json toJson(const Recorded& recorded, const Outcome* outcome) {
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
  for (const std::string* file : {&options.saveFile, &options.traceFile}) Context::checkWritable(*file);
  sayWhatIsLost(options.saveFile, context.log());
  Recorded recorded = load(context, options);
  std::optional<Outcome> outcome;
  std::string machine;
  if (options.recover) {
    saveKeeping(options.saveFile, editedCloud(recorded.model.cloud, recorded.points));
  } else {
    if (recorded.record.ticks.empty()) throw FileError(options.log, "has no whole tick; there is nothing to run again");
    const Again again = runAgain(context, recorded);
    if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, again.result.trace());
    outcome = compare(recorded, again, options.tolerance);
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
      "replay",
      "a recorded session again, in virtual time: force and points compared tick by tick; or its edits alone");
  auto options = std::make_shared<ReplayOptions>();
  sub.add("log", options->log,
          "what palpate touch --log wrote; of one that a crash cut off, that is damaged or met a full disk all that is "
          "whole is read, and what is missing is said")
      .required()
      .typeName("LOG");
  sub.add("--model", options->model, "the model of the session (default: the file that the log names)")
      .typeName("MODEL");
  sub.add("--tolerance", options->tolerance,
          "largest difference that counts as none, N for forces and mm for points (0: the same bits)")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
  sub.addFlag("--recover", options->recover, "run nothing: only do what was done to the points, and --save them");
  sub.add("--save", options->saveFile, "the points as the recorded edits leave them").typeName("OUT.ply");
  sub.add("--trace", options->traceFile, "of the session as it was run again, one row per tick").typeName("FILE.csv");
  sub.footer(
      "A session against the wall clock comes out the same only up to the first late answer; past it, and where points "
      "were taken in the order of their arrival, forces are not compared, and that is said. The recorded edits are "
      "held against the recorded end in any case.\n"
      "Exit code 1 when anything differs by more than the tolerance.\n");
  sub.whenNamed([&, options] { command = [&context, options] { replay(context, *options); }; });
}

}  // namespace palpate
