// The edits that the back ends report, and the effect of change(), followed by a history.
#include <thread>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/history_steps.hpp"
#include "tests/scenes.hpp"

namespace palpate::take_edits_test {

namespace {

BrushOptions softPush() { return {.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}; }

// `strokes` presses on the sphere's top, each a little further along, with the hand lifted in between.
std::vector<Contact> press(TouchBackend& touch, int strokes, History* history = nullptr) {
  constexpr int kTicks = 36;
  std::vector<Contact> contacts;
  EditBatch batch;
  for (int i = 0; i < strokes * kTicks; ++i) {
    const double phase = (i % kTicks) / (0.5 * kTicks), depth = 3 * (phase < 1 ? phase : 2 - phase);
    const double time_s = 1e-3 * i + 0.5 * (i / kTicks);  // far enough apart to be strokes
    contacts.push_back(touch.query({.time_s = time_s, .hip = {6.0 * (i / kTicks), 0, 51 - depth}}, 0));
    if (!history) continue;
    touch.edits()->take(batch);
    history->follow(batch);
    batch.clear();
  }
  touch.finish();
  if (history) {
    touch.edits()->take(batch);
    history->follow(batch);
  }
  return contacts;
}

void apply(TouchBackend& touch, History& history, std::span<const PointChange> changes) {
  touch.edits()->change(changes);
  EditBatch batch;
  touch.edits()->take(batch);
  CHECK(batch.marks.size() == (changes.empty() ? 0 : 1));
  for (const EditMark& mark : batch.marks) CHECK(mark.kind == EditMark::Kind::change);
  history.follow(batch);
}

bool same(const PointCloud& a, const PointCloud& b) {
  return a.positions == b.positions && a.normals == b.normals && a.colors == b.colors;
}

void checkFollowed(TouchBackend& touch, const PointCloud& cloud) {
  touch.edits()->keep();
  History history(cloud, {1 << 26});
  press(touch, 3, &history);
  CHECK(history.counts().strokes == 3);
  CHECK_FALSE(history.inStroke());
  CHECK(touch.edits()->progress().states > 300);
  PointCloud ended = cloud;
  const std::size_t changed = touch.readBack(ended);
  CHECK(changed > 50);
  CHECK(changedPoints(cloud, history.points()) == changed);
  CHECK(same(editedCloud(cloud, history.points()), ended));
}

// Two strokes, undone and redone; finally the cloud is as loaded.
void checkTakenBack(TouchBackend& touch, const PointCloud& cloud) {
  touch.edits()->keep();
  History history(cloud, {1 << 26});
  press(touch, 2, &history);
  PointCloud sculpted = cloud;
  CHECK(touch.readBack(sculpted) > 50);
  const auto undoBoth = [&] {
    for (int i = 0; i < 2; ++i) apply(touch, history, undone(history));
    PointCloud back = cloud;
    CHECK(touch.readBack(back) == 0);
    CHECK(same(back, cloud));
  };
  undoBoth();
  for (int i = 0; i < 3; ++i) apply(touch, history, redone(history));
  PointCloud redone = cloud;
  touch.readBack(redone);
  CHECK(same(redone, sculpted));
  undoBoth();
}

// Moves all points out by a tenth, except the last, which is said to be where it is not.
void checkRefused(TouchBackend& touch, const PointCloud& cloud) {
  touch.edits()->keep();
  History history(cloud, {1 << 26});
  press(touch, 1, &history);
  PointCloud before = cloud;
  touch.readBack(before);
  std::vector<PointChange> changes;
  for (const PointState& state : history.points()) {
    changes.push_back({state, state});
    changes.back().to.position *= 1.1F;
  }
  changes.back().from.position *= 2;
  CHECK_THROWS_WITH_AS(touch.edits()->change(changes), doctest::Contains("no point was changed"), Error);
  PointCloud after = cloud;
  touch.readBack(after);
  CHECK(same(after, before));
  EditBatch batch;
  touch.edits()->take(batch);
  CHECK(batch.empty());
  changes.back().from = history.points().end()[-1];
  apply(touch, history, changes);
  touch.readBack(after);
  CHECK(same(editedCloud(cloud, history.points()), after));
  CHECK(glm::distance(after.positions[0], 1.1F * before.positions[0]) < 1e-6F);
}

}  // namespace

TEST_CASE("a history that follows the CPU back end has the cloud bit by bit, stroke by stroke") {
  const Scene scene = makeScene("sphere", 20'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = softPush()});
  checkFollowed(touch, scene.cloud);
}

TEST_CASE_FIXTURE(GpuFixture, "a history that follows the GPU has the cloud bit by bit, stroke by stroke") {
  const Scene scene = makeScene("sphere", 20'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush()});
  checkFollowed(touch, scene.cloud);
}

TEST_CASE_FIXTURE(GpuFixture, "points removed by a brush are reported, with an updated or a rebuilt index") {
  const Scene scene = makeScene("sphere", 20'000);
  // The larger brush's box has more cells than there are buckets: it scans all slots, in several lists of moves.
  for (const double brushRadius : {8.0, 400.0})
    for (const IndexFollow index : {IndexFollow::incremental, IndexFollow::rebuild}) {
      CAPTURE(brushRadius);
      CAPTURE(index == IndexFollow::rebuild);
      const BrushOptions carve{.kind = BrushKind::carve, .yieldDepth = 0.3, .radius = brushRadius, .strength = 1};
      TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = carve, .index = index});
      touch.edits()->keep();
      History history(scene.cloud, {1 << 26});
      // Steps long enough that points are deep inside the brush.
      const int ticks = brushRadius > 100 ? 16 : 6;
      for (int i = 0; i < ticks; ++i) touch.query({.time_s = 1e-3 * i, .hip = {0, 0, 53 - 3.0 * i}}, 0);
      touch.finish();
      EditBatch batch;
      touch.edits()->take(batch);
      history.follow(batch);
      std::size_t gone = 0;
      for (const PointState& state : history.points()) gone += state.gone;
      CHECK(gone > 50);
      PointCloud ended = scene.cloud;
      touch.readBack(ended);
      CHECK(same(editedCloud(scene.cloud, history.points()), ended));
    }
}

TEST_CASE("after undo and redo on the CPU the cloud is felt and read back in its earlier and later state") {
  const Scene scene = makeScene("sphere", 20'000);
  const CpuTouchOptions options{.radius = scene.radius, .brush = softPush()};
  CpuTouch touch(scene.cloud, options), fresh(scene.cloud, options);
  checkTakenBack(touch, scene.cloud);
  const auto again = press(touch, 1), first = press(fresh, 1);
  for (std::size_t i = 0; i < first.size(); ++i) REQUIRE(again[i].proxy == first[i].proxy);
}

TEST_CASE_FIXTURE(
    GpuFixture,
    "after undo and redo on the GPU the cloud is felt and read back so, with an updated or a rebuilt index") {
  const Scene scene = makeScene("sphere", 20'000);
  for (const IndexFollow index : {IndexFollow::incremental, IndexFollow::rebuild}) {
    const TouchOptions options{.radius = scene.radius, .brush = softPush(), .index = index};
    TouchSide touch(device, scene.cloud, options), fresh(device, scene.cloud, options);
    checkTakenBack(touch, scene.cloud);
    // Points may have another order within a bucket, and be summed in that order.
    const auto again = press(touch, 1), first = press(fresh, 1);
    for (std::size_t i = 0; i < first.size(); ++i)
      REQUIRE(glm::distance(again[i].proxy, first[i].proxy) < 1e-4 * scene.radius);
  }
}

TEST_CASE_FIXTURE(GpuFixture,
                  "a change of many points that is refused at its end changes no point, and nothing is reported") {
  const Scene scene = makeScene("sphere", 20'000);
  for (const IndexFollow index : {IndexFollow::incremental, IndexFollow::rebuild}) {
    CAPTURE(index == IndexFollow::rebuild);
    TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush(), .index = index});
    checkRefused(touch, scene.cloud);
  }
}

TEST_CASE("points removed by a change are no longer felt on the CPU, and new ones are") {
  const Scene scene = makeScene("sphere", 20'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius});
  const auto feels = [&](double z) {
    for (const double above : {3, 1}) touch.query({.hip = {0, 0, z + above}}, 0);
    return touch.query({.hip = {0, 0, z - 0.2}}, 0).touching;
  };
  CHECK(feels(50));
  std::vector<PointChange> changes;
  auto states = statesOf(scene.cloud);
  for (const PointState& state : states) {
    if (state.position.z < 40) continue;
    PointChange change{state, state};
    change.to.gone = true;
    changes.push_back(change);
    PointState higher = state;  // the same cap, slightly farther out, of new points
    higher.number = static_cast<std::uint32_t>(states.size() + changes.size() - 1);
    higher.parent = state.number;
    higher.position.z += 10;
    changes.push_back({higher, higher});
    changes.back().from.gone = true;
  }
  // The new points' ids follow the file's without a gap.
  std::uint32_t next = static_cast<std::uint32_t>(states.size());
  for (PointChange& change : changes)
    if (change.to.number >= states.size()) change.to.number = next++;
  touch.edits()->change(changes);
  CHECK_FALSE(feels(50));
  CHECK(feels(60));
  PointCloud edited = scene.cloud;
  CHECK(touch.readBack(edited) == changes.size());
  CHECK(edited.size() == scene.cloud.size());
  for (PointChange& change : changes) std::swap(change.from, change.to);
  for (PointChange& change : changes)
    if (change.to.number >= states.size()) change.to = {.gone = true, .number = change.from.number};
  touch.edits()->change(changes);
  CHECK(feels(50));
  CHECK_FALSE(feels(60));
  edited = scene.cloud;
  CHECK(touch.readBack(edited) == 0);
  CHECK(same(edited, scene.cloud));
}

TEST_CASE("a change ends the stroke in progress, on the CPU in real time too, with a reader on another thread") {
  const Scene scene = makeScene("sphere", 5'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = softPush()});
  touch.edits()->keep();
  EditBatch all;
  {
    std::jthread follower([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) touch.edits()->take(all);
    });
    for (int i = 0; i < 200; ++i) touch.query({.time_s = 1e-3 * i, .hip = {0, 0, 51 - 0.02 * i}}, i % 4 ? 300 : 0);
    const PointState far = statesOf(scene.cloud).back();  // where it was
    touch.edits()->change(std::vector<PointChange>{{far, far}});
    for (int i = 0; i < 50; ++i) touch.query({.time_s = 0.2 + 1e-3 * i, .hip = {0, 0, 46}}, i % 4 ? 300 : 0);
    touch.finish();
  }
  touch.edits()->take(all);
  REQUIRE(all.marks.size() == 3);
  CHECK(all.marks[0].kind == EditMark::Kind::stroke);
  CHECK(all.marks[1] == EditMark{all.marks[0].at + 1, EditMark::Kind::change});
  CHECK(all.marks[2] == EditMark{all.points.size(), EditMark::Kind::stroke});
}

}  // namespace palpate::take_edits_test
