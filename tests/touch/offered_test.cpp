// Changes that others offer to each back end.
#include "engine/core/error.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"
#include "tests/touch/offering.hpp"

namespace palpate::offered_test {

namespace {

constexpr BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8, .resample = false};

// Strokes on the top of a sphere of 50 about the origin, while others change points elsewhere, or there as well.
void checkOffersAmidStrokes(TouchBackend& touch, const PointCloud& cloud, bool everywhere) {
  REQUIRE(touch.edits()->mostOffered() >= 64);
  Offering others(touch, cloud, onCpuOrGpu(2u, 1u));
  constexpr int kTicks = 60, kStrokes = 3;
  std::size_t elsewhere = 0, takenElsewhere = 0;
  bool isElsewhere = true;
  for (int i = 0; i < kStrokes * kTicks; ++i) {
    const double phase = (i % kTicks) / (0.5 * kTicks), depth = 3 * (phase < 1 ? phase : 2 - phase);
    const double time_s = 1e-3 * i + 0.5 * (i / kTicks);  // far enough apart to be strokes
    touch.query({.time_s = time_s, .hip = {6.0 * (i / kTicks), 0, 51 - depth}}, 0);
    if (i % 3 == 0) {
      const std::size_t before = others.taken();
      others.follow();
      if (isElsewhere && !others.isOffered()) takenElsewhere += others.taken() - before;
    }
    if (others.isOffered()) continue;
    // The hand reaches down to about 40 on the upper half.
    isElsewhere = !everywhere || i % 2 == 0;
    const auto chosen = [&](const PointState& point) { return (point.position.z < 20) == isElsewhere; };
    if (others.offer(40, 2, chosen) && isElsewhere) elsewhere += 40;
  }
  touch.finish();
  others.checkEnd();
  // Only a change that removes the ground under a hand may end its stroke.
  if (everywhere)
    CHECK(others.history().counts().strokes > 0);
  else
    CHECK(others.history().counts().strokes == kStrokes);
  CHECK(others.offers() > 50);
  CHECK(others.parts() > 10);
  CHECK(others.taken() > 1000);
  // Away from the hand all changes are applied as offered.
  CHECK(takenElsewhere > 500);
  CHECK(takenElsewhere + 40 >= elsewhere);
}

// The same stroke with and without changes of others, far from it.
void checkStrokesAmidOffers(TouchBackend& alone, TouchBackend& joined, const PointCloud& cloud) {
  alone.edits()->keep();
  Offering others(joined, cloud, 5);
  for (int i = 0; i < 80; ++i) {
    const Pose pose{.time_s = 1e-3 * i, .hip = {0.05 * i, 0, 51 - 0.05 * i}};
    alone.query(pose, 0);
    joined.query(pose, 0);
    others.follow();
    if (!others.isOffered()) others.offer(20, 1, [](const PointState& point) { return point.position.z < -20; });
  }
  alone.finish();
  joined.finish();
  others.checkEnd();
  CHECK(others.taken() > 200);
  PointCloud expected = cloud, found = cloud;
  alone.readBack(expected);
  joined.readBack(found);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].z < 0) continue;
    REQUIRE(glm::distance(found.positions[i], expected.positions[i]) <= onCpuOrGpu(0.0f, 1e-4f));  // sums differ
    REQUIRE(glm::distance(found.normals[i], expected.normals[i]) <= onCpuOrGpu(0.0f, 1e-3f));
  }
}

// A change that a caller has from somewhere else than the edits: none of the points changes.
void checkChangeFromElsewhere(TouchBackend& touch, const PointCloud& cloud) {
  touch.edits()->keep();
  touch.query({.time_s = 0, .hip = {0, 0, 200}}, 0);
  const std::vector<PointState> states = statesOf(cloud);
  std::vector<PointChange> changes{{states[0], states[0]}, {states[1], states[1]}};
  for (PointChange& change : changes) change.to.position.z += 1;
  changes[1].from.position += Vec3(30, 30, 30);
  CHECK_THROWS_AS(touch.edits()->change(changes), Error);
  touch.finish();
  PointCloud after = cloud;
  CHECK(touch.readBack(after) == 0);
  CHECK(after.positions == cloud.positions);
  EditBatch batch;
  touch.edits()->take(batch);
  CHECK(batch.points.empty());
}

// A change whose point has another state is not applied; after a change by another party none is; both are reported.
void checkOffersThatAreLate(TouchBackend& touch, const PointCloud& cloud) {
  Offering others(touch, cloud, 3);
  double time_s = 0;
  const auto rest = [&] {
    touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 200}}, 0);
    touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 200}}, 0);
    others.follow();
  };
  rest();
  const auto state = [&](std::uint32_t point) { return others.shown()[point]; };
  const auto moved = [&](std::uint32_t point, float z) {
    PointChange change{state(point), state(point)};
    change.to.position.z += z;
    return change;
  };
  // Points 1 and 2 are far from the positions that two of the changes state.
  PointChange wrong = moved(1, 5), gone = moved(2, 0);
  wrong.from.position += Vec3(30, 30, 30);
  wrong.to.color = 0xff112233;  // a change not applied does not paint either
  gone.from.position += Vec3(-30, 0, 7);
  gone.to.gone = true;
  REQUIRE(others.offerThese({moved(0, 5), wrong, gone, moved(3, -5)}));
  CHECK_FALSE(touch.edits()->offer({}, 0));  // one at a time
  rest();
  CHECK(others.reports() == 1);
  CHECK(others.lastTaken() == 2);
  CHECK(state(1) == statesOf(cloud)[1]);
  CHECK(state(2) == statesOf(cloud)[2]);
  CHECK(state(0).position.z == cloud.positions[0].z + 5);

  // Removed, and restored as it was.
  PointChange away = moved(7, 0);
  away.to.gone = true;
  REQUIRE(others.offerThese({away}));
  rest();
  CHECK(others.lastTaken() == 1);
  CHECK(state(7).gone);
  // Restored by another change meanwhile: the offer must not duplicate the point.
  std::swap(away.from, away.to);
  touch.edits()->change(std::vector{away});
  REQUIRE(others.offerThese({away}));
  rest();
  CHECK(others.reports() == 3);
  CHECK(others.lastTaken() == 0);
  CHECK(state(7) == statesOf(cloud)[7]);
  REQUIRE(others.offerThese({moved(7, 3)}));
  rest();
  CHECK(others.lastTaken() == 1);
  touch.finish();
  others.checkEnd();
  // An offer above the maximum is rejected.
  CHECK_FALSE(touch.edits()->offer(std::vector<PointChange>(touch.edits()->mostOffered() + 1, moved(9, 1)), 1));
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEnd, "strokes continue during edits of others, and each offer is reported once") {
  const Scene scene = makeScene("sphere", onCpuOrGpu(20'000, 8'000));
  for (const bool everywhere : {false, true}) {
    CAPTURE(everywhere);
    const IndexFollow index = kOnGpu && !everywhere ? IndexFollow::rebuild : IndexFollow::incremental;
    const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = kPush, .index = index, .threads = 0});
    checkOffersAmidStrokes(*touch, scene.cloud, everywhere);
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "a stroke is the same while others change points elsewhere") {
  const Scene scene = makeScene("sphere", onCpuOrGpu(20'000, 8'000));
  const TouchWanted wanted{.radius = scene.radius, .brush = kPush};
  const auto alone = make(scene.cloud, wanted), joined = make(scene.cloud, wanted);
  checkStrokesAmidOffers(*alone, *joined, scene.cloud);
}

TEST_CASE_FIXTURE(OnBackEnd, "a change of a point that is elsewhere is refused, and no point changes") {
  const Scene scene = makeScene("sphere", 5'000);
  const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = kPush});
  checkChangeFromElsewhere(*touch, scene.cloud);
}

TEST_CASE_FIXTURE(OnBackEnd, "an offer that is too late for a point leaves it unchanged") {
  const Scene scene = makeScene("sphere", 5'000);
  for (const IndexFollow index : {IndexFollow::incremental, IndexFollow::rebuild}) {
    CAPTURE(index == IndexFollow::rebuild);
    const TouchWanted wanted{.radius = scene.radius, .brush = kPush, .index = index, .paintable = true, .threads = 0};
    checkOffersThatAreLate(*make(scene.cloud, wanted), scene.cloud);
  }
}

}  // namespace palpate::offered_test
