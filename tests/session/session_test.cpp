// The session shared by all programs, on the CPU, in virtual time.
#include <doctest/doctest.h>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/devices/replay_device.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::session_test {

namespace {

SessionConfig feeling(std::size_t hands = 1) {
  return {.backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(hands)};
}

SessionConfig carving() {
  SessionConfig config = feeling();
  config.brush = BrushConfig{.kind = BrushKind::carve, .yieldDepth_mm = 0.2, .radius_mm = 8};
  return config;
}

/// Keeps all edits that it receives.
class Collector final : public EditFollower {
 public:
  explicit Collector(EditBatch& all) : all_(all) {}
  void catchUp(const EditBatch& batch) override {
    all_.points.insert(all_.points.end(), batch.points.begin(), batch.points.end());
  }

 private:
  EditBatch& all_;
};

bool samePoints(const PointCloud& a, const PointCloud& b) {
  return a.positions == b.positions && a.normals == b.normals;
}

}  // namespace

TEST_CASE("the force is the force law's spring on the surface, and feeling changes no point") {
  const auto cpu = cpuBackend();
  Session session(feeling(), sphereModel(), {.backend = *cpu, .keepsPoints = true});
  const ServoResult result = runAlone(session, strokeFrom({0, 0, 1}, 1));
  session.finish();
  const TraceSummary summary = summarize(result.trace());
  CHECK(summary.contactTicks > 80);
  CHECK(summary.faultTicks == 0);
  CHECK(summary.peakForce_N == near(0.8, 0.15));  // 1 mm deep at 0.8 N/mm, minus the average's bias
  CHECK(session.sculpted().edited == 0);
  CHECK(samePoints(session.sculpted().cloud, session.model().cloud));
}

TEST_CASE("four hands in one session each feel what they would feel alone") {
  const auto cpu = cpuBackend();
  const std::vector<DVec3> from{{0, 0, 1}, {1, 0, 0.1}, {-1, 1, 0}, {0.1, -1, -1}};
  std::vector<PathHand> hands;
  for (std::size_t i = 0; i < from.size(); ++i)
    hands.emplace_back(strokeFrom(from[i], 0.5 + 0.3 * static_cast<double>(i)));
  std::vector<OpenHand> open;
  for (const PathHand& hand : hands) open.push_back(hand.hand());
  Session session(feeling(4), sphereModel(), {.backend = *cpu});
  const ServoResult together = session.run(open, {});
  REQUIRE(together.hands.size() == 4);
  for (std::size_t i = 0; i < from.size(); ++i) {
    CAPTURE(i);
    Session alone(feeling(), sphereModel(), {.backend = *cpu});
    const ServoResult result = runAlone(alone, strokeFrom(from[i], 0.5 + 0.3 * static_cast<double>(i)));
    CHECK(summarize(result.trace()).contactTicks > 80);
    CHECK(sameTrace(result.trace(), together.hands[i].trace));
  }
}

TEST_CASE("carving reaches history and follower alike, and undo restores the points bit for bit") {
  const auto cpu = cpuBackend();
  EditBatch followed;
  Session session(
      carving(), sphereModel(),
      {.backend = *cpu, .keepsPoints = true, .undo = {1 << 24}, .followers = {[&](const Model&, TouchBackend&) {
                                                                  return std::make_unique<Collector>(followed);
                                                                }}});
  runAlone(session, strokeFrom({0, 0, 1}, 2));
  session.finish();
  CHECK(session.sculpted().edited > 20);
  History replayed(session.model().cloud);
  replayed.follow(followed);
  CHECK(samePoints(editedCloud(session.model().cloud, replayed.points()), session.sculpted().cloud));

  const PointCloud carved = session.sculpted().cloud;
  const UndoneStrokes undone = session.undo(1, 0);
  CHECK(undone.undone == 1);
  CHECK(session.sculpted().edited == 0);
  CHECK(samePoints(session.sculpted().cloud, session.model().cloud));
  CHECK(session.undo(0, 1).redone == 1);
  CHECK(samePoints(session.sculpted().cloud, carved));
}

TEST_CASE("a recorded session contains its configuration and is replayed with the same forces and points") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  const auto cpu = cpuBackend();
  SessionConfig config = carving();
  config.model.file = (folder / "model.ply").string();
  config.surface = {.kind = SurfaceKind::sphere, .friction = 0.2};
  Session session(config, sphereModel(), {.backend = *cpu, .keepsPoints = true});
  const ServoResult result = runRecorded(session, log, strokeFrom({0, 0, 1}, 2));

  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  CHECK(recorded.config == config);
  CHECK(recorded.checksum == checksumOf(session.model()));
  REQUIRE(record.end);
  REQUIRE(record.ticks.size() == result.trace().rows.size());
  Session again(recorded.config, sphereModel(), {.backend = *cpu, .keepsPoints = true});
  const ServoResult same = runAgain(again, std::move(record), recorded);
  again.finish();
  CHECK(sameTrace(result.trace(), same.trace()));
  CHECK(again.sculpted().edited > 20);
  CHECK(samePoints(again.sculpted().cloud, session.sculpted().cloud));
  CHECK(checksumOf(again.model().cloud.origin, again.history()->points()) == record.end->points);
}

TEST_CASE("a log of an older palpate without a configuration is refused with that palpate's version") {
  CHECK_THROWS_WITH_AS(parseHeader("old.session", R"({"palpate": "0.0.9", "options": {"--edit": "carve"}})"),
                       doctest::Contains("older palpate, 0.0.9"), FileError);
}

TEST_CASE("a back end is selected by name, and refuses what it cannot do before anything is built") {
  std::vector<std::unique_ptr<BackendKind>> kinds;
  kinds.push_back(cpuBackend());
  const Backends backends(std::move(kinds));
  CHECK(backends.names() == std::vector<std::string>{"cpu"});
  CHECK_THROWS_AS(backends.named("abacus"), ConfigError);
  SessionConfig config = feeling();
  config.backend.ahead = true;
  CHECK_THROWS_AS(Session(config, sphereModel(), {.backend = backends.named("cpu")}), ConfigError);
  config = feeling();
  config.rate_Hz = 0;
  CHECK_THROWS_AS(Session(config, sphereModel(), {.backend = backends.named("cpu")}), ConfigError);
}

TEST_CASE("a session without a history refuses recording and undo, and leaves no file") {
  const ScratchFolder folder;
  const auto cpu = cpuBackend();
  Session session(carving(), sphereModel(), {.backend = *cpu});
  const PathHand hand(strokeFrom({0, 0, 1}, 1));
  CHECK_THROWS_AS(session.record((folder / "log").string(), hand.hand()), Error);
  CHECK_FALSE(std::filesystem::exists(folder / "log"));
  CHECK_THROWS_AS(session.undo(1, 0), Error);
}

}  // namespace palpate::session_test
