// Layers of strokes in a session, on each back end: the hand feels them as strong as they are, and undo, logs and
// replays repeat each slide.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/edit/stroke_layers.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/error_of.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::stroke_layers_session_test {

namespace {

struct Layered {
  explicit Layered(BrushKind brush = BrushKind::push, std::size_t points = 16'000)
      : model(sphereModel(points)), session(sculpting(brush), model, parts()) {}

  static SessionConfig sculpting(BrushKind brush) {
    SessionConfig config{.model = {.file = "sphere"}, .backend = {.name = std::string(backendKind()->name())}};
    config.model.mm_per_unit = 1;
    config.brush = BrushConfig{.kind = brush, .yieldDepth_mm = 0.3, .radius_mm = 8};
    config.rate_Hz = onCpuOrGpu(1000.0, 500.0);
    return config;
  }
  SessionParts parts() const { return {.backend = *kind, .threads = 1, .keepsPoints = true, .undo = {1 << 27}}; }

  void stroke(const DVec3& direction = {0.02, 0, 1}, double depth = 3) {
    const std::uint64_t before = session.strokes().strokes;
    runAlone(session, strokeFrom(direction, depth));
    session.finish();
    REQUIRE(session.strokes().strokes == before + 1);
  }
  void layer(bool isOpen) {
    const StrokeLayers& layers = session.scene().layers[0].attributes.strokeLayers();
    session.setStrokeLayer(0, layers.size() ? layers[0] : StrokeLayer{"dents"}, isOpen);
  }
  void slide(double strength, bool continues = false) {
    session.setStrokeLayer(0, {.name = "dents", .strength = strength}, false, continues);
    session.finish();
  }
  std::vector<PointState> points() const {
    const PointStates& states = session.history()->points();
    return {states.begin(), states.end()};
  }
  /// Distance from the centre at which a hand is stopped that presses the top lightly.
  double feltRadius() {
    session.setBrush(std::nullopt);
    const ServoResult result = runAlone(session, Path({{0, {1, 0, 56}}, {0.2, {1, 0, 46}}}));
    session.setBrush(sculpting(BrushKind::push).brush);
    for (const TraceRow& row : result.trace().rows) {
      CHECK(row.valid);
      if (row.contact) return glm::length(row.proxy);
    }
    return 0;
  }

  std::unique_ptr<BackendKind> kind = backendKind();
  Model model;
  Session session;
};

std::size_t differences(const std::vector<PointState>& a, const std::vector<PointState>& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const bool inA = i < a.size() && !a[i].gone, inB = i < b.size() && !b[i].gone;
    different += inA != inB || (inA && !isSameToTheBit(a[i], b[i]));
  }
  return different;
}

}  // namespace

TEST_CASE("a layer of real strokes slides to what was before and after them bit by bit, and the hand feels it") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::carve, BrushKind::inflate}) {
    CAPTURE(traitsOf(kind).name);
    Layered scene(kind);
    scene.stroke({0.3, 0.9, 0.2});
    const std::vector<PointState> before = scene.points();
    scene.layer(true);
    scene.stroke();
    scene.stroke({0.1, 0.1, 1});
    if (kind == BrushKind::carve) scene.session.changePoints(PointSet::range(5'000, 5'040), RemovePoints());
    const std::vector<PointState> after = scene.points();
    REQUIRE(differences(before, after) > 100);
    if (kind == BrushKind::carve) CHECK(std::ranges::count(after, true, &PointState::gone) > 0);
    const double made = scene.feltRadius();
    const std::size_t entries = scene.session.strokes().undoCount;
    scene.slide(0);
    CHECK(differences(scene.points(), before) == 0);
    const double smooth = scene.feltRadius();
    CHECK(smooth == within(50, 0.2));
    CHECK(std::abs(made - smooth) > 0.3);
    scene.slide(0.5);
    const std::vector<PointState> half = scene.points();
    std::size_t wrong = 0, aside = 0, changed = 0;  // where strokes have crossed, points are beside the middle
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i].gone || after[i].gone) continue;
      const DVec3 middle = 0.5 * (DVec3(before[i].position) + DVec3(after[i].position));
      const double off = glm::distance(DVec3(half[i].position), middle);
      changed += before[i].position != after[i].position;
      aside += off > 1e-5;
      wrong += !(off < 2 * scene.model.spacing);
    }
    CHECK(wrong == 0);
    CHECK(5 * aside < changed);
    if (kind != BrushKind::carve) CHECK(scene.feltRadius() == within(0.5 * (made + smooth), 0.25));
    scene.slide(1);
    CHECK(differences(scene.points(), after) == 0);
    CHECK(scene.session.strokes().undoCount == entries + 3);
    for (const auto* const there : {&half, &before, &after}) {
      CHECK(scene.session.undo(1, 0).undone == 1);
      CHECK(differences(scene.points(), *there) == 0);
    }
    CHECK(scene.session.undo(3, 3).redone == 3);
    CHECK(differences(scene.points(), after) == 0);
    scene.slide(0);
    CHECK(differences(scene.points(), before) == 0);
  }
}

TEST_CASE("strokes beside an open layer, and slides in a row, have entries as a user expects them") {
  Layered scene;
  scene.layer(true);
  scene.stroke();
  CHECK(scene.session.strokes().undoCount == 2);
  scene.slide(0.9);
  for (int i = 8; i > 0; --i) scene.slide(0.1 * i, true);
  CHECK(scene.session.strokes().undoCount == 3);
  const std::vector<PointState> dragged = scene.points();
  scene.stroke({1, 0, 0.1});  // the layer was closed by sliding
  const std::vector<PointState> after = scene.points();
  scene.slide(0);
  std::size_t kept = 0, moved = 0;
  const std::vector<PointState> smooth = scene.points();
  for (std::size_t i = 0; i < dragged.size(); ++i) {
    if (isSameToTheBit(dragged[i], after[i])) continue;
    ++moved;
    kept += isSameToTheBit(smooth[i], after[i]);
  }
  CHECK(moved > 50);
  CHECK(kept == moved);
  CHECK(scene.session.undo(2, 0).undone == 2);
  CHECK(differences(scene.points(), dragged) == 0);
  CHECK(scene.session.scene().layers[0].attributes.strokeLayers()[0].strength == within(0.1, 1e-12));
}

TEST_CASE("a slide leaves locked points as they are, and points that are locked in part go the rest of their way") {
  Layered scene;
  const std::vector<PointState> before = scene.points();
  scene.layer(true);
  scene.stroke();
  const std::vector<PointState> after = scene.points();
  std::vector<std::uint8_t> weights(before.size());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = i % 3 == 0 ? PointLock::kWhole : i % 3 == 1 ? 51 : 0;
  scene.session.setLockWeights(weights);
  scene.slide(0);
  const std::vector<PointState> slid = scene.points();
  std::size_t locked = 0, partly = 0, aside = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].gone || after[i].gone || before[i].position == after[i].position) continue;
    const DVec3 moved = DVec3(after[i].position) - DVec3(before[i].position);
    locked += i % 3 == 0;
    partly += i % 3 == 1;
    if (i % 3 == 0) CHECK(isSameToTheBit(slid[i], after[i]));
    const double off = glm::distance(DVec3(slid[i].position), DVec3(before[i].position) + 0.2 * moved);
    if (i % 3 == 1) CHECK(off < scene.model.spacing);
    aside += i % 3 == 1 && off > 1e-5;
    if (i % 3 == 2) CHECK(isSameToTheBit(slid[i], before[i]));
  }
  CHECK(locked > 20);
  CHECK(partly > 20);
  CHECK(5 * aside < partly);
  scene.session.setLockWeights(std::vector<std::uint8_t>(before.size()));
  scene.slide(1);
  CHECK(differences(scene.points(), after) == 0);
  CHECK(scene.session.undo(1, 0).undone == 1);
  CHECK(differences(scene.points(), slid) == 0);
  scene.slide(0.5);
  scene.slide(0);
  CHECK(differences(scene.points(), before) == 0);
}

TEST_CASE("a recorded session repeats layers, strokes and slides in contact bit by bit, with bounded forces") {
  const ScratchFolder folder;
  const std::string log = (folder / "layers.palpate").string();
  Layered scene;
  const PathHand hand(strokeFrom({0.02, 0, 1}, 2, 0.6));
  const OpenHand open = hand.hand();
  scene.session.record(log, open);
  std::size_t ticks = 0;
  const auto at = [&](double part) { return ticks == static_cast<std::size_t>(part * scene.session.config().rate_Hz); };
  RunOptions options;
  options.before = [&](std::uint64_t) {
    ++ticks;
    if (at(0.05)) scene.layer(true);
    if (at(0.28)) scene.session.setMask(MaskRole::locked, PointSet::range(0, 8'000));
    if (at(0.3)) scene.session.setStrokeLayer(0, {.name = "dents", .strength = 0.2}, false);
    if (at(0.34)) scene.session.setStrokeLayer(0, {.name = "dents", .strength = 0}, false, true);
    if (at(0.4)) scene.session.undo(1, 0);
    if (at(0.44)) scene.session.undo(0, 1);
  };
  const ServoResult result = scene.session.run({&open, 1}, options);
  scene.session.finish();
  scene.session.endRecording();
  CHECK(scene.session.strokes().strokes > 1);
  double most_N = 0, jump_N = 0;
  DVec3 last{0};
  for (const TraceRow& row : result.trace().rows) {
    most_N = std::max(most_N, glm::length(row.force_N));
    jump_N = std::max(jump_N, glm::distance(row.force_N, std::exchange(last, row.force_N)));
  }
  CHECK(most_N > 0.3);
  CHECK(most_N < 4);
  CHECK(jump_N < 1);

  const Backends backends = theBackends();
  Log silent(true);
  const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &scene.model.cloud};
  Recorded recorded = loadRecorded(log, parts);
  CHECK(recorded.attributes.strokeLayers().size() == 1);
  CHECK(recorded.attributes.strokeLayers()[0].strength == 0);
  CHECK_FALSE(recorded.attributes.strokeLayers()[0].held.empty());
  const SessionAgain again = runAgain(recorded, parts);
  const ReplayOutcome outcome = compareRuns(recorded, again, 0);
  CHECK(outcome.comparable.because == "");
  CHECK(outcome.differences.ends);
  CHECK(outcome.differences.forceTicks == 0);
  CHECK(outcome.differences.points == 0);
}

TEST_CASE("a layer of most points of a cloud slides step by step, as one entry" * kMoreInFull) {
  const auto count = byTier<std::size_t>(20'000, 1'100'000), changed = byTier<std::size_t>(10'000, 1'000'000);
  Layered scene(BrushKind::push, count);
  const std::vector<PointState> before = scene.points();
  scene.layer(true);
  scene.session.changePoints(PointSet::range(0, changed), MovePoints{.scale = 1.01, .offset = {0.1, 0, 0}});
  const std::vector<PointState> after = scene.points();
  scene.slide(0.99);
  constexpr int kSlides = 60;
  std::vector<double> slid_ms;
  for (int i = 1; i <= kSlides; ++i) {
    const Stopwatch since;
    scene.session.setStrokeLayer(0, {.name = "dents", .strength = 1 - static_cast<double>(i) / kSlides}, false, true);
    slid_ms.push_back(1e3 * since.elapsed_s());
  }
  std::ranges::sort(slid_ms);
  if (inFullTier())
    MESSAGE(changed << " points: median " << slid_ms[kSlides / 2] << " ms, longest " << slid_ms.back() << " ms");
  CHECK(differences(scene.points(), before) == 0);
  scene.slide(1);
  CHECK(differences(scene.points(), after) == 0);
  CHECK(scene.session.undo(2, 0).undone == 2);
  CHECK(differences(scene.points(), after) == 0);
}

namespace {

/// Counts how changes are given; it carries them out at once.
struct CountedStream : EditStream {
  void keep() override {}
  void take(EditBatch& batch) override {
    batch.points.insert(batch.points.end(), left.begin(), left.end());
    if (!std::exchange(left, {}).empty()) batch.marks.push_back({batch.points.size(), EditMark::Kind::change});
  }
  EditProgress progress() const noexcept override { return {}; }
  void change(std::span<const PointChange> changes) override {
    ++single;
    for (const PointChange& each : changes) left.push_back(each.to);
  }
  bool changeMany(const PointSet& points, std::span<const PointState> states) override {
    ++many;
    points.forEach([&](std::uint64_t point) { left.push_back(states[point]); });
    return true;
  }
  bool offer(std::span<const PointChange>, std::uint64_t) override { return false; }
  std::size_t mostOffered() const override { return 0; }

  std::vector<PointState> left;
  int single = 0, many = 0;
};

}  // namespace

TEST_CASE("a stroke of a layer that a command makes, its slides and their undo are given to the back end all at once") {
  const Model model = sphereModel(4'000);
  LayerAttributes attributes;
  CountedStream stream;
  EditRelay relay(model.cloud, attributes, &stream, nullptr, {.keepsPoints = true, .undo = {1 << 26}});
  relay.change(StrokeLayerChange{.set = {"a"}, .open = 0});
  const PointStates& points = relay.history()->points();
  const std::vector<PointState> before(points.begin(), points.end());
  BareVector<PointState> raised(before.begin(), before.begin() + 2'000);
  for (PointState& state : raised) state.position *= 1.01f;
  relay.changeMany(std::move(raised));
  const std::vector<PointState> after(points.begin(), points.end());
  for (const double strength : {0.5, 0.25, 0.0}) {
    StrokeLayerChange slide{.set = {"a", strength}, .moves = StrokeLayerChange::Points::slideContinued};
    relay.slide(std::move(slide));
  }
  CHECK(differences({points.begin(), points.end()}, before) == 0);
  CHECK(relay.history()->counts().undoCount == 3);
  CHECK(relay.undo(1, 0).undone == 1);
  CHECK(differences({points.begin(), points.end()}, after) == 0);
  CHECK(stream.many == 5);
  CHECK(stream.single == 0);
}

TEST_CASE("layers are refused by name, and a refusal changes nothing") {
  Layered scene;
  const auto refusal = [&](std::uint32_t number, const StrokeLayer& set) {
    return errorOf([&] { scene.session.setStrokeLayer(number, set, false); });
  };
  CHECK(says(refusal(1, {"a"}), "the model has 0 layers"));
  CHECK(says(refusal(0, {"a", 2.5}), "the strength must be from -1 to 2"));
  CHECK(scene.session.strokes().undoCount == 0);
  scene.session.setStrokeLayer(0, {.name = "a"}, true);
  scene.stroke();
  scene.session.setStrokeLayer(0, {.name = "a", .isMerged = true}, false);
  CHECK(says(refusal(0, {"a", 0}), "were merged"));
  CHECK(scene.session.strokes().undoCount == 3);
  CHECK(scene.session.undo(1, 0).undone == 1);
  scene.slide(0);
  CHECK(scene.session.strokes().undoCount == 3);
}

}  // namespace palpate::stroke_layers_session_test
