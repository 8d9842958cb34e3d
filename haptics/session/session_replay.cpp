#include "haptics/session/session_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/edit/point_states.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/recorded_edits.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

namespace {

// Applies the edits of the log, which may change points and append new ones.
void applyEdits(Recorded& recorded) {
  requireEditsOf(recorded.file, recorded.model.cloud.size(), recorded.record);
  History history(recorded.model.cloud);
  followAgain(history, recorded.attributes, recorded.record.edits);
  recorded.points.assign(history.points().begin(), history.points().end());
}

/// Collects all edits.
class EditCollector final : public EditFollower {
 public:
  explicit EditCollector(EditBatch& all) : all_(all) {}
  void catchUp(const EditBatch& batch) override { append(all_, batch); }

 private:
  EditBatch& all_;
};

/// The commands of a log, given again.
class CommandsAgain {
 public:
  CommandsAgain(const SessionRecord& record, Session& session) : record_(record), session_(session) {}

  /// Before a loop runs: gives those with which the recording began.
  void begin() {
    for (; isBefore(0) && isWithoutLoop(record_.commands[next_]); ++next_) give(record_.commands[next_]);
  }
  /// Gives those before that tick.
  void repeat(std::uint64_t tick) {
    while (isBefore(tick)) give(record_.commands[next_++]);
  }
  /// After the loop: gives the rest, as far as it changes what the session ends with.
  void finish() {
    for (; next_ < record_.commands.size(); ++next_)
      if (isWithoutLoop(record_.commands[next_])) give(record_.commands[next_]);
  }

 private:
  bool isBefore(std::uint64_t tick) const {
    return next_ < record_.commands.size() && record_.commands[next_].tick <= tick;
  }
  static bool isWithoutLoop(const LoggedCommand& command) {
    using Kind = LoggedCommand::Kind;
    constexpr std::array kKinds{Kind::begin, Kind::attribute, Kind::points, Kind::undo, Kind::redo, Kind::cancel};
    return std::ranges::count(kKinds, command.kind) > 0;
  }
  // In a damaged log a change may be missing, or not fit without one that is.
  void give(const LoggedCommand& command) {
    if (command.kind != LoggedCommand::Kind::attribute) return session_.repeat(command);
    const AttributeChange* const change = nextChange();
    if (change && session_.scene().layers[0].attributes.fits(*change)) session_.change(*change);
  }
  // Null where it is missing.
  const AttributeChange* nextChange() {
    const std::vector<EditMark>& marks = record_.edits.marks;
    while (mark_ < marks.size()) {
      const EditMark& mark = marks[mark_++];
      if (!mark.hasAttribute()) continue;
      const AttributeChange& change = record_.edits.attributes[change_++];
      if (mark.kind == EditMark::Kind::attribute) return &change;
    }
    return nullptr;
  }

  const SessionRecord& record_;
  Session& session_;
  std::size_t next_ = 0, mark_ = 0, change_ = 0;
};

/// Where the session was when its recording began.
class Beginning {
 public:
  explicit Beginning(const SessionRecord& record) {
    for (const LoggedCommand& command : record.commands)
      if (command.kind == LoggedCommand::Kind::begin) state_ = command.content;
  }
  const std::string& state() const { return state_; }
  // The ticks at their times in that session.
  std::vector<LoggedTick> inSession(std::vector<LoggedTick> ticks, double rate_Hz) const {
    struct {
      double begin_s, number;
    } first;  // ServoLoop::saveState() begins with these
    if (state_.size() < sizeof first) return ticks;
    std::memcpy(&first, state_.data(), sizeof first);
    for (LoggedTick& tick : ticks)
      tick.time_s = first.begin_s + (first.number + std::round(tick.time_s * rate_Hz)) / rate_Hz;
    return ticks;
  }

 private:
  std::string state_;
};

// Memory for strokes that a command undoes.
std::uint64_t undoOf(const SessionRecord& record) {
  const bool undoes = std::ranges::any_of(record.commands, [](const LoggedCommand& command) {
    using Kind = LoggedCommand::Kind;
    return command.kind == Kind::undo || command.kind == Kind::redo || command.kind == Kind::cancel;
  });
  UndoConfig undo;
  undo.undo = undoes;
  return undoBytes(undo);
}

// Number of masks and fields that differ.
std::size_t differing(std::vector<std::uint64_t> a, std::vector<std::uint64_t> b) {
  const std::size_t count = std::max(a.size(), b.size()), shared = std::min(a.size(), b.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < shared; ++i) same += a[i] == b[i];
  return count - same;
}

}  // namespace

Recorded loadRecorded(const std::string& log, const ReplayParts& parts) {
  Recorded recorded;
  recorded.file = log;
  recorded.record = readSessionLog(log);
  recorded.session = parseHeader(log, recorded.record.text);
  const SessionRecord& record = recorded.record;
  SessionConfig& config = recorded.session.config;
  ModelConfig& model = config.model;
  if (!parts.model.empty()) {
    model.file = parts.model;
    config.model.join.reset();
  }
  const bool isHere = parts.cloud && !config.model.matter && !config.model.stream;
  if (config.model.join && !isHere)
    throw FileError(model.file,
                    fmt::format("was served by another program; save its points and name them with {}", parts.naming));
  if (!config.model.matter && !isHere && !std::filesystem::exists(model.file))
    throw FileError(model.file, fmt::format("does not exist; name the model of the session with {}", parts.naming));
  const BackendKind& kind = parts.backends.named(config.backend.name);
  const ModelLoading loading{.log = parts.log, .threads = parts.threads, .estimate = kind.normalEstimator()};
  recorded.model = isHere ? modelOf(*parts.cloud, model, loading) : loadModel(model, loading);
  recorded.scale = recorded.model.scale;
  const std::string points = counted(recorded.model.cloud.size(), "point");
  if (isHere && recorded.model.cloud.size() != recorded.session.points)
    throw UsageError("cloud: has {}, the model of the session had {}", points, recorded.session.points);
  if (recorded.model.cloud.size() != recorded.session.points)
    throw FileError(model.file, fmt::format("has {}, the model of the session had {}; name the right model with {}",
                                            points, recorded.session.points, parts.naming));
  const bool isSame = checksumOf(recorded.model) == recorded.session.checksum;
  if (!isSame && isHere) throw UsageError("cloud: its points differ from those of the session");
  if (!isSame)
    throw FileError(
        model.file,
        fmt::format("has changed since the session: its points differ; name the right model with {}", parts.naming));
  const auto falls = [](const LoggedTick& a, const LoggedTick& b) { return !(a.time_s < b.time_s); };
  if (std::ranges::adjacent_find(record.ticks, falls) != record.ticks.end())
    throw FileError(log, "its ticks are not in the order of time; it is damaged");
  applyEdits(recorded);
  if (record.end)
    recorded.endsAsRecorded =
        checksumOf(recorded.model.cloud.origin, recorded.points, recorded.attributes) == record.end->points;
  return recorded;
}

SessionAgain runAgain(Recorded& recorded, const ReplayParts& parts) {
  const SessionRecord& record = recorded.record;
  if (record.ticks.empty()) throw FileError(recorded.file, "contains no complete tick, so it cannot be replayed");
  const SessionConfig& present = recorded.session.config;
  SessionConfig config = recorded.session.built;
  config.model = present.model;
  config.realtime = false;
  config.hands = {HandConfig{}};
  config.duration_s = 0;  // that of the recording
  config.rate_Hz = present.rate_Hz;
  SessionAgain again;
  Session session(
      config, std::move(recorded.model),
      {.backend = parts.backends.named(config.backend.name),
       .threads = parts.threads,
       .keepsPoints = true,
       .undo = {std::max(undoBytes(config.undo), undoOf(record))},
       .paintable = recorded.session.paintable,
       .log = &parts.log,
       .followers = {[&](const Model&, TouchBackend&) { return std::make_unique<EditCollector>(again.edits); }}});
  if (present.brush != config.brush) session.setBrush(present.brush);
  if (present.surface != config.surface || present.force != config.force || present.backend != config.backend)
    session.setContact(present.surface, present.force, present.backend.method);
  const Beginning beginning(record);
  ReplayDevice device(beginning.inSession(record.ticks, config.rate_Hz), recorded.session.limits);
  TickTap tap(session.backend().edits(), [&](const LoggedTick& tick) { again.ticks.push_back(tick); });
  const OpenHand hand{.device = &device,
                      .map = recorded.session.map,
                      .duration_s = record.ticks.back().time_s,
                      .passivity = recorded.session.passivity};
  CommandsAgain commands(record, session);
  commands.begin();
  again.result = session.run({&hand, 1}, {.forcesOn = &device.forcesOn(),
                                          .recorder = &tap,
                                          .before = [&](std::uint64_t tick) { commands.repeat(tick); },
                                          .resume = beginning.state()});
  throwIfStopWanted();
  session.finish();
  commands.finish();
  if (record.end) session.undo(config.undo.undo, config.undo.redo);
  session.checkFollower();
  again.points.assign(session.history()->points().begin(), session.history()->points().end());
  again.attributes = session.scene().layers[0].attributes;
  return again;
}

std::string reasonOf(const ReplayOutcome& outcome, const Recorded& recorded) {
  if (outcome.differences.ends || !outcome.comparable.because.empty()) return outcome.comparable.because;
  return recorded.record.end ? "a part of the log is missing" : "the log does not contain the end of the session";
}

ReplayOutcome compareRuns(const Recorded& recorded, const SessionAgain& again, double tolerance) {
  const SessionConfig& config = recorded.session.config;
  const bool ordered = config.backend.name == "cpu" || config.backend.deterministic;
  const Tolerance allowed{tolerance, recorded.scale};
  ReplayOutcome outcome{.comparable = comparableTicks(recorded.record, config.rate_Hz, config.realtime, ordered)};
  if (config.realtime && config.moves())
    outcome.comparable = {0, "in real time the frames of a moving model are received when they are ready"};
  outcome.differences = compareTicks({recorded.record.ticks, &recorded.record.edits}, {again.ticks, &again.edits},
                                     outcome.comparable.count, allowed);
  outcome.differences.ends =
      recorded.record.end && recorded.record.gaps.empty() && outcome.comparable.count == recorded.record.ticks.size();
  if (!outcome.differences.ends) return outcome;
  outcome.differences.points = differingPoints(recorded.points, again.points, allowed);
  outcome.differences.attributes =
      differing(checksumsOf(recorded.attributes, recorded.points), checksumsOf(again.attributes, again.points));
  return outcome;
}

}  // namespace palpate
