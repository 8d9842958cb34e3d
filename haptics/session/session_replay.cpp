#include "haptics/session/session_replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/edit/point_states.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

namespace {

// The points after the edits of a log, which may change points and append new ones.
std::vector<PointState> edited(const std::string& log, const Model& model, const SessionRecord& record) {
  requireEditsOf(log, model.cloud.size(), record);
  PointStates points(model.cloud);
  points.set(record.edits.points);
  return {points.begin(), points.end()};
}

/// Collects all edits.
class EditCollector final : public EditFollower {
 public:
  explicit EditCollector(EditBatch& all) : all_(all) {}
  void catchUp(const EditBatch& batch) override { append(all_, batch); }

 private:
  EditBatch& all_;
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
    return command.kind == LoggedCommand::Kind::undo || command.kind == LoggedCommand::Kind::redo;
  });
  UndoConfig undo;
  undo.undo = undoes;
  return undoBytes(undo);
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
  recorded.points = edited(log, recorded.model, record);
  if (record.end)
    recorded.endsAsRecorded = checksumOf(recorded.model.cloud.origin, recorded.points) == record.end->points;
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
  auto next = record.commands.begin();
  const auto repeat = [&](std::uint64_t tick) {
    for (; next != record.commands.end() && next->tick <= tick; ++next) session.repeat(*next);
  };
  again.result = session.run(
      {&hand, 1}, {.forcesOn = &device.forcesOn(), .recorder = &tap, .before = repeat, .resume = beginning.state()});
  throwIfStopWanted();
  session.finish();
  if (record.end) session.undo(config.undo.undo, config.undo.redo);
  session.checkFollower();
  again.points.assign(session.history()->points().begin(), session.history()->points().end());
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
  if (outcome.differences.ends) outcome.differences.points = differingPoints(recorded.points, again.points, allowed);
  return outcome;
}

}  // namespace palpate
