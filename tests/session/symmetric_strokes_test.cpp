// Strokes with symmetry, and strokes that are taken back, on each back end.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::symmetric_strokes_test {

namespace {

// A sphere of radius 50 whose points are mirror images of each other at x = 0: the second half of the other one.
Model symmetricModel(std::size_t points) {
  Model model = sphereModel(points);
  PointCloud half;
  for (std::size_t i = 0; i < model.cloud.size(); ++i) {
    if (!(model.cloud.positions[i].x > 0.05f)) continue;
    half.positions.push_back(model.cloud.positions[i]);
    half.normals.push_back(model.cloud.normals[i]);
  }
  const std::size_t count = half.positions.size();
  for (std::size_t i = 0; i < count; ++i) {
    half.positions.push_back(half.positions[i] * Vec3(-1, 1, 1));
    half.normals.push_back(half.normals[i] * Vec3(-1, 1, 1));
  }
  model.cloud = half;
  measure(model, {.mm_per_unit = 1}, 1);
  return model;
}

SessionConfig sculpting(BrushKind kind, const std::string& symmetry) {
  SessionConfig config{.model = {.file = "sphere"}, .backend = {.name = std::string(backendKind()->name())}};
  config.model.mm_per_unit = 1;
  config.brush = BrushConfig{.kind = kind, .yieldDepth_mm = 0.3, .radius_mm = 8, .resample = false};
  config.brush->symmetry = symmetry;
  config.rate_Hz = onCpuOrGpu(1000.0, 500.0);
  return config;
}

struct Sculpted {
  explicit Sculpted(const SessionConfig& config, std::size_t points = 8'000)
      : model(symmetricModel(points)), session(config, model, parts()) {}
  SessionParts parts() const { return {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 26}}; }

  void stroke(const Path& path, const RunOptions& options = {}) {
    runAlone(session, path, options);
    session.finish();
  }
  std::vector<PointState> points() const {
    const PointStates& states = session.history()->points();
    return {states.begin(), states.end()};
  }
  double moved(std::size_t i) const {
    return glm::distance(DVec3(session.history()->points()[i].position), DVec3(model.cloud.positions[i]));
  }
  std::size_t half() const { return model.cloud.size() / 2; }
  /// Of the points from `first` up to `last`.
  double mostMoved(std::size_t first, std::size_t last) const {
    double most = 0;
    for (std::size_t i = first; i < last; ++i) most = std::max(most, moved(i));
    return most;
  }
  /// There a point is worked by the hand and by its image for as long together as by the hand alone; farther off the
  /// stroke and its image come by one after the other.
  double mostMovedAtThePlane() const {
    double most = 0;
    for (std::size_t i = 0; i < model.cloud.size(); ++i)
      if (std::abs(model.cloud.positions[i].x) < 1) most = std::max(most, moved(i));
    return most;
  }
  /// Of a point from the mirror image of its partner.
  double mostApart() const {
    double most = 0;
    for (std::size_t i = 0; i < half(); ++i) {
      const PointState here = session.history()->points()[i], there = session.history()->points()[half() + i];
      if (here.gone || there.gone) continue;
      most = std::max(most, glm::distance(DVec3(here.position), DVec3(there.position) * DVec3(-1, 1, 1)));
    }
    return most;
  }
  double leastRadius() const {
    double least = 1e9;
    for (const PointState& point : session.history()->points())
      if (!point.gone) least = std::min(least, glm::length(DVec3(point.position)));
    return least;
  }

  std::unique_ptr<BackendKind> kind = backendKind();
  Model model;
  Session session;
};

/// Over the top of the sphere, across x = 0 at a right angle.
Path acrossThePlane(double depth) {
  std::vector<PathKey> keys;
  const auto at = [](double r, double turn) { return r * glm::normalize(DVec3(turn, 0.02, 1)); };
  keys.push_back({0, at(52, -0.3)});
  for (int k = 0; k <= 10; ++k) keys.push_back({0.05 + 0.03 * k, at(50 - depth, -0.3 + 0.06 * k)});
  keys.push_back({0.4, at(53, 0.3)});
  return Path(keys);
}

bool isSame(const std::vector<PointState>& a, const std::vector<PointState>& b) {
  return std::ranges::equal(a, b, isSameToTheBit);
}

}  // namespace

TEST_CASE("with symmetry both sides of the model are changed alike, by as much as the hand's side without it") {
  for (const BrushTraits& brush : kBrushes) {
    CAPTURE(brush.name);
    const Path path = strokeFrom({0.5, 0.1, 1}, 2);
    Sculpted alone(sculpting(brush.kind, {})), both(sculpting(brush.kind, "x"));
    alone.stroke(path);
    both.stroke(path);
    CHECK(both.session.strokes().undoCount == 1);
    const std::size_t half = both.half();
    double mostHere = 0, mostMoved = both.mostMoved(0, half);
    std::size_t changed = 0, differing = 0;
    for (std::size_t i = 0; i < half; ++i) {
      const PointState here = both.session.history()->points()[i], there = both.session.history()->points()[half + i];
      changed += !isSameToTheBit(here, PointStates(both.model.cloud)[i]);
      differing += here.gone != there.gone || here.color != there.color;
      if (here.gone) continue;
      const PointState without = alone.session.history()->points()[i];
      if (!without.gone) mostHere = std::max(mostHere, glm::distance(DVec3(here.position), DVec3(without.position)));
    }
    CHECK(changed > 15);
    CHECK(differing == 0);
    CHECK(both.mostApart() <= onCpuOrGpu(0.0, 1e-5));
    // Flatten and smooth are slow, and follow the hand by half as many, larger edits.
    const bool isSlow = brush.kind == BrushKind::flatten || brush.kind == BrushKind::smooth;
    if (brush.kind != BrushKind::carve) CHECK(mostHere < (isSlow ? 0.5 : 0.15) * mostMoved + 0.01);
    CHECK(alone.mostMoved(half, 2 * half) == 0);
    // One change of the history.
    CHECK(both.session.undo(1, 0).undone == 1);
    CHECK(both.mostMoved(0, 2 * half) == 0);
  }
}

TEST_CASE("a stroke that crosses the plane of symmetry is as deep as without symmetry") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::inflate, BrushKind::smooth, BrushKind::carve}) {
    CAPTURE(traitsOf(kind).name);
    Sculpted alone(sculpting(kind, {})), both(sculpting(kind, "x"));
    alone.stroke(acrossThePlane(2));
    both.stroke(acrossThePlane(2));
    CHECK(alone.mostMovedAtThePlane() > 0.002);
    CHECK(both.mostMovedAtThePlane() == near(alone.mostMovedAtThePlane(), 0.2));
    CHECK(both.leastRadius() == near(alone.leastRadius(), 0.005));
    CHECK(both.mostApart() < 5e-5);  // single precision: neighbours are added in another order
  }
}

TEST_CASE("a plane through any position mirrors a stroke, and one that is not of the model is refused in words") {
  const DVec3 normal = glm::normalize(DVec3(1, 2, 0.5));
  Sculpted both(sculpting(BrushKind::push, fmt::format("0,0,0,{},{},{}", normal.x, normal.y, normal.z)));
  const DVec3 from(-0.6, -0.8, 0.7);  // behind the plane
  both.stroke(strokeFrom(from, 2));
  const DVec3 there = 50.0 * glm::normalize(from - 2 * glm::dot(from, normal) * normal),
              here = 50.0 * glm::normalize(from);
  double movedHere = 0, movedThere = 0;
  for (std::size_t i = 0; i < both.model.cloud.size(); ++i) {
    const DVec3 place(both.model.cloud.positions[i]);
    if (glm::distance(place, here) < 12) movedHere = std::max(movedHere, both.moved(i));
    if (glm::distance(place, there) < 12) movedThere = std::max(movedThere, both.moved(i));
  }
  CHECK(movedHere > 0.5);
  CHECK(movedThere == near(movedHere, 0.15));
  for (const char* const plane : {"w", "xy", "1,2,3", "0,0,0,0,0,0", "1,2,3,4,5,6,7", "1,2,3,4,5,nan", ",,,,,"}) {
    CAPTURE(plane);
    const std::string said = errorOf<ConfigError>([&] { validate(sculpting(BrushKind::push, plane)); });
    CHECK(said.starts_with("brush.symmetry: is "));
  }
}

TEST_CASE("a stroke that is taken back in contact leaves every point as it was, and none follows until the release") {
  for (const bool mirrored : {false, true}) {
    CAPTURE(mirrored);
    SessionConfig config = sculpting(BrushKind::push, mirrored ? "x" : "");
    config.brush->resample = true;  // inserted points go, too
    Sculpted scene(config);
    scene.stroke(strokeFrom({0, 1, 0.2}, 1.5));
    CHECK(scene.session.strokes().undoCount == 1);
    CHECK_FALSE(scene.session.cancelStroke());  // it has ended
    const std::vector<PointState> before = scene.points();
    bool isCancelled = false;
    std::size_t editedThen = 0;
    RunOptions options;
    const double rate_Hz = config.rate_Hz;
    std::uint64_t tick = 0;
    options.before = [&](std::uint64_t) {
      if (++tick != static_cast<std::uint64_t>(0.12 * rate_Hz)) return;
      scene.session.catchUp();
      editedThen = scene.session.history()->points().size() - before.size();
      CHECK(scene.session.history()->inStroke());
      isCancelled = scene.session.cancelStroke();
    };
    const ServoResult result = runAlone(scene.session, strokeFrom({0.5, 0.1, 1}, 3), options);
    scene.session.finish();
    CHECK(isCancelled);
    CHECK(editedThen > 0);
    std::vector<PointState> after = scene.points();
    for (std::size_t i = before.size(); i < after.size(); ++i) CHECK(after[i].gone);
    after.resize(before.size());
    CHECK(isSame(before, after));
    const StrokeCounts counts = scene.session.strokes();
    CHECK(counts.undoCount == 1);
    CHECK(counts.redoCount == 0);
    CHECK(counts.strokes == 1);
    // The force goes on within its limit.
    const std::vector<TraceRow>& rows = result.trace().rows;
    std::size_t pressing = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      CHECK(rows[i].valid);
      CHECK(glm::distance(rows[i].force_N, rows[i - 1].force_N) <= 600 / rate_Hz + 1e-9);
      pressing += rows[i].time_s > 0.13 && rows[i].contact;
    }
    CHECK(pressing > static_cast<std::size_t>(0.02 * rate_Hz));
    scene.stroke(strokeFrom({0.5, 0.1, 1}, 2));  // pressed again
    CHECK(scene.session.strokes().undoCount == 2);
    CHECK(scene.mostMoved(0, scene.half()) > 0.5);
  }
}

TEST_CASE("a recording with a stroke that was taken back is played again with the same forces and points") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  Sculpted scene(sculpting(BrushKind::push, "x"));
  const PathHand hand(strokeFrom({0.5, 0.1, 1}, 2, 0.3));
  const OpenHand open = hand.hand();
  scene.session.record(log, open);
  std::uint64_t tick = 0;
  RunOptions options;
  options.before = [&](std::uint64_t) {
    if (++tick == static_cast<std::uint64_t>(0.15 * scene.session.config().rate_Hz))
      CHECK(scene.session.cancelStroke());
  };
  scene.session.run({&open, 1}, options);
  scene.session.finish();
  scene.session.endRecording();
  CHECK(scene.session.strokes().strokes == 0);
  const Backends backends = theBackends();
  Log silent(true);
  const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &scene.model.cloud};
  Recorded recorded = loadRecorded(log, parts);
  CHECK(std::ranges::count(recorded.record.commands, LoggedCommand::Kind::cancel, &LoggedCommand::kind) == 1);
  const SessionAgain again = runAgain(recorded, parts);
  const ReplayOutcome outcome = compareRuns(recorded, again, 0);
  CHECK(outcome.comparable.because == "");
  CHECK(outcome.differences.ends);
  CHECK(outcome.differences.forceTicks == 0);
  CHECK(outcome.differences.points == 0);
}

}  // namespace palpate::symmetric_strokes_test
