// Commands reach a hand in contact: no knock, no tick without force, one thread, and a log that repeats them.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <random>

#include "engine/core/log.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/labels.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/command_storm.hpp"
#include "tests/session/wall_stream.hpp"

namespace palpate::command_storm_test {

namespace {

constexpr double kSurface_N = 0.06;  // in a tick

/// A live session whose ticks this thread lets pass.
struct Stepped {
  explicit Stepped(Session& live, const std::atomic<bool>* forcesOn = nullptr) : session(live) {
    session.start({hand.hand()}, {.clock = clock, .forcesOn = forcesOn});
  }
  ~Stepped() { session.stop(); }
  Stepped(const Stepped&) = delete;
  Stepped& operator=(const Stepped&) = delete;
  void goOn(double duration_s) {
    clock->goOnTo(clock_s += duration_s);
    session.live()->take(rows);
    session.catchUp();
  }

  Session& session;
  PressingHand hand;
  std::shared_ptr<SteppedClock> clock = std::make_shared<SteppedClock>();
  double clock_s = 0;
  std::vector<TraceRow> rows;
};

// Largest difference of a log's forces from those of its replay, N, and ticks between which the edits differ.
Differences replayed(const std::string& log, const PointCloud& cloud) {
  const Backends backends = theBackends();
  Log silent(true);
  const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &cloud};
  Recorded recorded = loadRecorded(log, parts);
  const SessionAgain again = runAgain(recorded, parts);
  const ReplayOutcome outcome = compareRuns(recorded, again, 0);
  CHECK(outcome.comparable.because == "");
  CHECK(outcome.comparable.count == recorded.record.ticks.size());
  CHECK(outcome.differences.ends);
  return outcome.differences;
}

void checkSame(const Differences& differences) {
  CHECK(differences.ticks > 0);
  CHECK(differences.forceTicks == 0);
  CHECK(differences.editTicks == 0);
  CHECK(differences.points == 0);
  CHECK(differences.largestForce_N == 0);
}

}  // namespace

TEST_CASE("a thousand commands in contact change the force by 60 N/s at most, and a replay repeats them bit by bit" *
          kMoreInFull) {
  const ScratchFolder folder;
  const double duration_s = onCpuOrGpu(10.0, byTier(0.3, 2.0));
  const auto kind = backendKind();
  SessionConfig config = stormy(*kind, (folder / "sphere.ply").string());
  config.model.mm_per_unit = 1;
  Session session(config, sphereModel(),
                  {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 28}, .paintable = true});
  session.setBrush(std::nullopt);
  const PointCloud cloud = session.model().cloud;
  Stepped steps(session);
  steps.goOn(1.5);
  REQUIRE(steps.rows.back().contact);
  const double from_s = 1.4;

  // Recordings that begin and end in contact, before the first edit.
  for (int i = 0; i < 10; ++i) {
    session.record((folder / ("felt" + std::to_string(i))).string(), steps.hand.hand());
    steps.goOn(0.02);
    session.endRecording();
    steps.goOn(0.005);
  }
  session.record((folder / "log").string(), steps.hand.hand());
  RandomCommands random(session, 7);
  while (steps.clock_s < 1.75 + duration_s) {
    if (random.count % 7 != 0) {
      random.one();
      steps.goOn(0.01);
      continue;
    }
    // One that takes its time: the planes answer meanwhile.
    session.between([&] {
      steps.goOn(0.02);
      CHECK_FALSE(steps.rows.back().fresh);
      random.one();
    });
    steps.goOn(0.01);
  }
  session.endRecording();
  steps.goOn(0.02);
  session.stop();

  CHECK(static_cast<double>(random.count) > 75 * duration_s);
  const Felt felt = feltIn(steps.rows, from_s);
  CHECK(felt.without == 0);
  CHECK(felt.most_N < kSurface_N + 1e-9);
  CHECK(felt.most_N > 0.5 * kSurface_N);  // the commands were felt
  CHECK(steps.hand.threads() == 1);
  CHECK(session.strokes().strokes > (kOnGpu ? 0 : 3));
  for (const char* log : {"felt0", "felt9", "log"}) {
    CAPTURE(log);
    checkSame(replayed((folder / log).string(), cloud));
  }
}

TEST_CASE("a stroke that is taken back in contact leaves no change and no knock, and a replay takes it back, too") {
  const ScratchFolder folder;
  const auto kind = backendKind();
  SessionConfig config = stormy(*kind, (folder / "sphere.ply").string());
  config.model.mm_per_unit = 1;
  Session session(config, sphereModel(), {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 28}});
  session.setBrush(std::nullopt);
  Stepped steps(session);
  steps.goOn(1.5);
  REQUIRE(steps.rows.back().contact);
  session.record((folder / "log").string(), steps.hand.hand());
  session.setBrush(config.brush);
  steps.goOn(0.1);
  REQUIRE(session.history()->inStroke());
  CHECK(session.cancelStroke());
  CHECK_FALSE(session.cancelStroke());
  const auto isAsLoaded = [&] {
    const PointStates loaded(session.model().cloud);
    return std::ranges::all_of(session.history()->points(), [&](const PointState& point) {
      return point.number < loaded.size() ? isSameToTheBit(point, loaded[point.number]) : point.gone;
    });
  };
  CHECK(isAsLoaded());
  steps.goOn(0.1);
  CHECK(steps.rows.back().contact);
  CHECK(isAsLoaded());
  const StrokeCounts counts = session.strokes();
  CHECK(counts.undoCount + counts.redoCount + counts.strokes == 0);
  session.endRecording();
  steps.goOn(0.02);
  session.stop();
  const Felt felt = feltIn(steps.rows, 1.4);
  CHECK(felt.most_N <= kSurface_N);
  CHECK(felt.without == 0);
  checkSame(replayed((folder / "log").string(), session.model().cloud));
}

TEST_CASE("a replay switches the forces off and on at the same ticks as the user did") {
  const ScratchFolder folder;
  const auto kind = backendKind();
  SessionConfig config = stormy(*kind, (folder / "sphere.ply").string());
  config.model.mm_per_unit = 1;
  Session session(config, sphereModel(), {.backend = *kind, .threads = 1, .keepsPoints = true});
  session.setBrush(std::nullopt);
  std::atomic<bool> on = false;
  Stepped steps(session, &on);
  steps.goOn(0.01);
  const std::string log = (folder / "log").string();
  session.record(log, steps.hand.hand());
  steps.goOn(0.02);
  on = true;  // the hand is outside: a ramp begins
  steps.goOn(0.4);
  REQUIRE(glm::length(steps.rows.back().force_N) > 0.1);
  on = false;
  steps.goOn(0.01);
  CHECK(steps.rows.back().force_N == DVec3(0));
  session.endRecording();
  steps.goOn(0.01);  // none of these ticks is in the log
  session.stop();

  const std::vector<LoggedTick> ticks = readSessionLog(log).ticks;
  CHECK(std::ranges::count_if(ticks, [](const LoggedTick& tick) { return tick.has(LoggedTick::kForcesOff); }) == 30);
  checkSame(replayed(log, session.model().cloud));
}

TEST_CASE("a command has its effect at the hand within two ticks") {
  const auto kind = backendKind();
  Session session(stormy(*kind, "sphere"), sphereModel(), {.backend = *kind, .threads = 1, .keepsPoints = true});
  session.setBrush(std::nullopt);
  Stepped steps(session);
  steps.goOn(1.5);
  const double before_N = glm::length(steps.rows.back().force_N);
  ForceOptions force;
  force.stiffness_N_per_mm = 2;
  session.setContact({}, force, "");
  const std::size_t at = steps.rows.size();
  steps.goOn(0.002);
  REQUIRE(steps.rows.size() == at + 2);
  CHECK(glm::length(steps.rows.back().force_N) > before_N + 0.5 * kSurface_N);
}

TEST_CASE("frames of a depth camera that commands pause, resume and step change the force by 60 N/s at most") {
  const ScratchFolder folder;
  writeWall(folder.path());
  SessionConfig config = playing(folder.path());
  config.model.stream->loop = true;
  config.realtime = true;
  const auto cpu = cpuBackend();
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  const PathHand hand(atRest(60));
  const auto clock = std::make_shared<SteppedClock>();
  session.start({hand.hand()}, {.clock = clock});
  std::vector<TraceRow> rows;
  double clock_s = 0;
  const auto goOn = [&](double duration_s) {
    clock->goOnTo(clock_s += duration_s);
    session.live()->take(rows);
  };
  std::mt19937 random(5);
  std::size_t pauses = 0;
  for (int i = 0; i < byTier(300, 3000); ++i) {
    const auto frames = static_cast<Session::Frames>(random() % 3);
    session.between([&] {
      if (i % 5 == 0) goOn(0.01);  // it takes its time
      session.setFrames(frames);
    });
    pauses += session.player()->isPaused();
    for (int tick = 0; tick < 10; ++tick) goOn(0.001);
  }
  session.stop();
  REQUIRE(rows.size() > 3000);
  double most_N = 0, peak_N = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    most_N = std::max(most_N, glm::distance(rows[i].force_N, rows[i - 1].force_N));
    peak_N = std::max(peak_N, glm::length(rows[i].force_N));
  }
  CHECK(most_N < kSurface_N + 1e-9);
  CHECK(most_N > 0.5 * kSurface_N);  // the frames were felt
  CHECK(peak_N > 0.3);
  CHECK(pauses > 50);
  CHECK(session.playCounts()->played > 20);
}

}  // namespace palpate::command_storm_test
