// Hidden points cannot be felt, and locked ones cannot be changed, on each back end; undo, logs and other sessions
// restore both.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::masked_session_test {

namespace {

SessionConfig pushing() {
  SessionConfig config{.model = {.file = "sphere"}, .backend = {.name = std::string(backendKind()->name())}};
  config.model.mm_per_unit = 1;
  config.brush = BrushConfig{.yieldDepth_mm = 0.3, .radius_mm = 8};
  config.rate_Hz = onCpuOrGpu(1000.0, 500.0);
  return config;
}

struct Masked {
  explicit Masked(std::size_t points = 16'000) : model(sphereModel(points)), session(pushing(), model, parts()) {}
  SessionParts parts() const { return {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 26}}; }

  template <class Chosen>
  PointSet where(Chosen&& chosen) const {
    PointSet set;
    for (std::uint64_t i = 0; i < model.cloud.size(); ++i)
      if (chosen(model.cloud.positions[i])) set.set(i);
    return set;
  }
  // Largest force of a stroke across the top, N.
  double stroke(const DVec3& direction = {0.02, 0, 1}) {
    const ServoResult result = runAlone(session, strokeFrom(direction, 2));
    session.finish();
    double most_N = 0;
    for (const TraceRow& row : result.trace().rows) {
      CHECK(row.valid);
      most_N = std::max(most_N, glm::length(row.force_N));
    }
    return most_N;
  }
  std::vector<PointState> points() const {
    const PointStates& states = session.history()->points();
    return {states.begin(), states.end()};
  }

  std::unique_ptr<BackendKind> kind = backendKind();
  Model model;
  Session session;
};

std::size_t changedAmong(const PointSet& points, const std::vector<PointState>& before,
                         const std::vector<PointState>& after) {
  std::size_t changed = 0;
  points.forEach([&](std::uint64_t point) { changed += !isSameToTheBit(before[point], after[point]); });
  return changed;
}

// Whether the points are as before, and what was new is gone.
bool areAsBefore(const std::vector<PointState>& before, const std::vector<PointState>& after) {
  return after.size() >= before.size() && std::equal(before.begin(), before.end(), after.begin()) &&
         std::ranges::all_of(std::span(after).subspan(before.size()), &PointState::gone);
}

bool isTop(const Vec3& position) { return position.z > 20; }
bool isRight(const Vec3& position) { return position.x > 0; }

}  // namespace

TEST_CASE(
    "hidden points cannot be felt or changed, are saved, and are felt again when they are shown or it is undone") {
  Masked scene;
  const PointSet top = scene.where(isTop);
  const std::vector<PointState> before = scene.points();
  scene.session.setMask(MaskRole::hidden, top);
  CHECK(scene.stroke() == 0);
  CHECK(areAsBefore(before, scene.points()));
  CHECK(scene.session.strokes().strokes == 0);
  CHECK(scene.session.sculpted().cloud.positions == scene.model.cloud.positions);
  CHECK(scene.stroke({0, 0, -1}) > 0.3);  // the bottom is there
  CHECK(changedAmong(top, before, scene.points()) == 0);
  CHECK(scene.session.undo(1, 0).undone == 1);
  CHECK(areAsBefore(before, scene.points()));

  scene.session.setMask(MaskRole::hidden, {});
  CHECK(scene.stroke() > 0.3);
  CHECK(changedAmong(top, before, scene.points()) > 5);
  CHECK(scene.session.undo(2, 0).undone == 2);  // the stroke, and that they were shown
  CHECK(areAsBefore(before, scene.points()));
  CHECK(scene.stroke() == 0);
  CHECK(scene.session.undo(1, 0).undone == 1);  // that they were hidden
  CHECK(scene.stroke() > 0.3);
}

TEST_CASE("a stroke beside hidden points changes none of them, and what it undoes and redoes is the same") {
  Masked scene;
  const PointSet right = scene.where(isRight);
  const std::vector<PointState> before = scene.points();
  scene.session.setMask(MaskRole::hidden, right);
  CHECK(scene.stroke({-0.3, 0, 1}) > 0.3);
  const std::vector<PointState> after = scene.points();
  CHECK(changedAmong(right, before, after) == 0);
  CHECK(scene.session.strokes().strokes == 1);
  scene.session.undo(1, 0);
  CHECK(areAsBefore(before, scene.points()));
  scene.session.undo(0, 1);
  CHECK(scene.points() == after);
  // Shown again they are where they were: the hand feels the surface there.
  scene.session.setMask(MaskRole::hidden, {});
  CHECK(scene.points() == after);
  CHECK(scene.stroke({0.6, 0, 1}) > 0.3);
  CHECK(changedAmong(right, after, scene.points()) > 5);
}

TEST_CASE("brushes change no locked points, and where some are within, these alone") {
  Masked scene;
  const PointSet right = scene.where(isRight);
  PointSet left = PointSet::range(0, scene.model.cloud.size());
  left.remove(right);
  for (const MaskRole role : {MaskRole::locked, MaskRole::within}) {
    CAPTURE(static_cast<int>(role));
    const PointSet& kept = role == MaskRole::locked ? right : left;
    const PointSet& changed = role == MaskRole::locked ? left : right;
    const std::vector<PointState> before = scene.points();
    scene.session.setMask(role, right);
    CHECK(scene.stroke() > 0.3);  // it is felt all the same
    CHECK(changedAmong(kept, before, scene.points()) == 0);
    CHECK(changedAmong(changed, before, scene.points()) > 5);
    CHECK(scene.session.undo(2, 0).undone == 2);
    scene.stroke();
    CHECK(changedAmong(kept, before, scene.points()) > 5);
    CHECK(scene.session.undo(1, 0).undone == 1);
  }
}

TEST_CASE("a recorded session repeats hidings and locks in contact, bit by bit") {
  const ScratchFolder folder;
  const std::string log = (folder / "masks.palpate").string();
  Masked scene;
  const PathHand hand(strokeFrom({0.02, 0, 1}, 2, 0.4));
  const OpenHand open = hand.hand();
  scene.session.record(log, open);
  std::size_t ticks = 0;
  const auto command = [&] {
    ++ticks;
    const std::size_t at = static_cast<std::size_t>(scene.session.config().rate_Hz);
    if (ticks == at / 8) scene.session.setMask(MaskRole::locked, scene.where(isRight));
    if (ticks == at / 6) {  // right half in part
      std::vector<std::uint8_t> weights = scene.session.lockWeights();
      for (std::uint8_t& weight : weights) weight /= 2;
      scene.session.setLockWeights(weights);
    }
    if (ticks == at / 5) scene.session.setMask(MaskRole::hidden, scene.where(isTop));
    if (ticks == at / 4) scene.session.setMask(MaskRole::hidden, {});
  };
  RunOptions options;
  options.before = [&](std::uint64_t) { command(); };
  scene.session.run({&open, 1}, options);
  scene.session.finish();
  scene.session.endRecording();
  CHECK(scene.session.strokes().strokes > 0);

  const Backends backends = theBackends();
  Log silent(true);
  const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &scene.model.cloud};
  Recorded recorded = loadRecorded(log, parts);
  const SessionAgain again = runAgain(recorded, parts);
  const ReplayOutcome outcome = compareRuns(recorded, again, 0);
  CHECK(outcome.comparable.because == "");
  CHECK(outcome.differences.ends);
  CHECK(outcome.differences.forceTicks == 0);
  CHECK(outcome.differences.points == 0);
}

TEST_CASE("points that are locked in part yield less, undo restores their locks, and a file has them") {
  Masked scene;
  const std::vector<PointState> before = scene.points();
  const auto moved = [&] {  // mean displacement of the points around the middle of the stroke, which is undone
    const std::vector<PointState> after = scene.points();
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (std::hypot(before[i].position.x, before[i].position.y) < 3 && before[i].position.z > 0) {
        sum += glm::distance(before[i].position, after[i].position);
        ++count;
      }
    scene.session.undo(1, 0);
    CHECK(areAsBefore(before, scene.points()));
    return sum / static_cast<double>(count);
  };
  scene.stroke();
  const double whole = moved();
  CHECK(whole > 0.2);
  // A mask of bits while no point is locked in part, and a field from then on.
  const LayerAttributes& attributes = scene.session.scene().layers[0].attributes;
  const auto weights = [&] {
    std::vector<std::uint8_t> all = scene.session.lockWeights();
    all.resize(before.size());
    return all;
  };
  const std::vector<std::uint8_t> none(before.size()), half(before.size(), 128);
  std::vector<std::uint8_t> right(before.size()), mixed = half;
  scene.where(isRight).forEach([&](std::uint64_t point) { right[point] = 255, mixed[point] = 0; });
  scene.session.setLockWeights(right);
  CHECK(attributes.fields().empty());
  CHECK(existing(attributes.mask(MaskRole::locked), scene.points()) == scene.where(isRight));
  scene.session.setLockWeights(half);
  CHECK(weights() == half);
  CHECK(attributes.fields().size() == 1);
  scene.stroke();
  CHECK(moved() / whole == within(0.5, 0.1));
  scene.session.setMask(MaskRole::locked, PointSet::range(0, before.size()));
  CHECK(scene.stroke() > 0.3);
  CHECK(areAsBefore(before, scene.points()));
  scene.session.setLockWeights(none);
  scene.session.setLockWeights(mixed);
  // Each of them is one change, which undo and redo exchange whole.
  CHECK(scene.session.undo(1, 0).undone == 1);
  CHECK(weights() == none);
  CHECK(scene.session.undo(2, 0).undone == 2);
  CHECK(weights() == half);
  CHECK(scene.session.undo(1, 0).undone == 1);
  CHECK(weights() == right);
  CHECK(attributes.fields().empty());
  scene.stroke();
  CHECK(changedAmong(scene.where(isRight), before, scene.points()) == 0);
  CHECK(scene.session.undo(1, 0).undone == 1);
  CHECK(scene.session.undo(0, 4).redone == 1);
}

TEST_CASE("undo and redo tell which change they took, and which one is next") {
  Masked scene;
  scene.stroke();
  const std::size_t selected = scene.where(isRight).count();
  scene.session.setMask(MaskRole::selected, scene.where(isRight));
  const UndoneStrokes first = scene.session.undo(1, 0);
  CHECK(first.last.what == "selection");
  CHECK(first.last.points == fmt::format("{} points", selected));
  REQUIRE(first.next);
  CHECK(first.next->what == "stroke");
  const UndoneStrokes second = scene.session.undo(1, 0);
  CHECK(second.last.what == "stroke");
  CHECK(second.last.points == first.next->points);
  CHECK_FALSE(second.next);
  const UndoneStrokes back = scene.session.undo(0, 2);
  CHECK(back.last.what == "selection");
  REQUIRE(back.next);
  CHECK(back.next->what == "selection");
}

TEST_CASE("a file with the property lock is locked by it, also for new points") {
  const Masked source;
  Model model = source.model;
  Attribute lock{std::string(kLockField), ScalarType::u8, std::vector<std::byte>(model.cloud.size(), std::byte{255})};
  model.cloud.extra.push_back(lock);
  const std::unique_ptr<BackendKind> kind = backendKind();
  Session locked(pushing(), model, source.parts());
  const auto stroke = [](Session& session) {
    CHECK(runAlone(session, strokeFrom({0.02, 0, 1}, 2)).trace().rows.size() > 10);
    session.finish();
  };
  stroke(locked);
  CHECK(locked.strokes().strokes == 0);
  locked.setMask(MaskRole::locked, {});
  stroke(locked);
  CHECK(locked.strokes().strokes == 1);
  // New points have the lock of the point that they come from: in a session that saves them they stay.
  std::vector<std::uint8_t> weights(locked.history()->points().size(), 7);
  locked.setLockWeights(weights);
  const PointCloud saved =
      editedCloud(model.cloud, locked.history()->points(), locked.scene().layers[0].attributes.fields());
  const auto field = std::ranges::find(saved.extra, kLockField, &Attribute::name);
  REQUIRE(field != saved.extra.end());
  CHECK(std::ranges::count(field->data, std::byte{7}) == static_cast<std::ptrdiff_t>(saved.size()));
}

TEST_CASE("a session that begins with the masks of another one feels and changes the same points") {
  Masked first;
  const PointSet top = first.where(isTop);
  first.session.setMask(MaskRole::hidden, top);
  first.session.setMask(MaskRole::locked, first.where([](const Vec3& position) { return position.z < -20; }));
  const EditBatch history = first.session.attributeHistory();
  CHECK(first.stroke() == 0);  // the history was read without showing them
  Masked next;
  next.session.followAgain(history);
  const std::vector<PointState> before = next.points();
  CHECK(next.stroke() == 0);
  CHECK(next.stroke({0, 0, -1}) > 0.3);
  CHECK(areAsBefore(before, next.points()));
  CHECK(next.stroke({1, 0, 0}) > 0.3);
  CHECK(next.points() != before);
}

TEST_CASE("points are hidden and locked only where they can be edited, and a refusal changes nothing") {
  Masked scene;
  SessionConfig config = pushing();
  config.brush.reset();
  Session felt(config, scene.model, scene.parts());
  const PointSet top = scene.where(isTop);
  if (!kOnGpu) return;  // the CPU can
  CHECK_THROWS_AS(felt.setMask(MaskRole::hidden, top), Error);
  CHECK_THROWS_AS(felt.setMask(MaskRole::locked, top), Error);
  CHECK(felt.scene().layers[0].attributes.mask(MaskRole::hidden).empty());
  CHECK(felt.scene().layers[0].attributes.mask(MaskRole::locked).empty());
  felt.setMask(MaskRole::selected, top);
  CHECK(felt.strokes().undoCount == 1);
}

}  // namespace palpate::masked_session_test
