// Points that appear and vanish all at once, on each back end.
#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::replace_test {

namespace {

/// A hand that sculpts and feels, and the states of its points.
class Hand {
 public:
  Hand(TouchBackend& touch, const PointCloud& cloud) : touch_(touch), history_(cloud, {1 << 26}) {
    touch.edits()->keep();
  }
  // Into the surface along the z axis, across it, and out again; the largest depth of contact.
  double press(double sign) {
    double most = 0;
    touch_.resetHand(0);
    for (int i = 0; i <= 80; ++i) {
      const double t = i / 80.0;
      const DVec3 hip(-6 + 12 * t, -0.2, sign * (53 - 7 * std::min(1.0, 3 * t)));
      const Contact contact = touch_.query({.time_s = time_s_ += 1e-3, .hip = hip}, 0);
      CHECK(contact.valid);
      if (contact.touching) most = std::max(most, glm::distance(contact.proxy, hip));
    }
    touch_.query({.time_s = time_s_ += 1e-3, .hip = {0, 0, sign * 80}}, 0);
    follow();
    return most;
  }
  std::size_t follow() {
    touch_.finish();
    EditBatch batch;
    touch_.edits()->take(batch);
    history_.follow(batch);
    return batch.points.size() + batch.marks.size();
  }
  bool undo() {
    return history_.undo({.points =
                              [&](std::span<const PointChange> changes) {
                                touch_.edits()->change(changes);
                                return true;
                              },
                          .shape = {},
                          .attributes = {}});
  }
  std::span<const PointState> states() const { return history_.points(); }

 private:
  TouchBackend& touch_;
  History history_;
  double time_s_ = 0;
};

PointSet above(std::span<const PointState> states, float z) {
  PointSet set;
  for (const PointState& state : states)
    if (state.position.z > z) set.set(state.number);
  return set;
}

// What the back end has is what the states say.
void checkHas(const TouchBackend& touch, const PointCloud& cloud, std::span<const PointState> states) {
  PointCloud present = cloud;
  touch.readBack(present);
  const PointCloud expected = editedCloud(cloud, states);
  CHECK(present.positions == expected.positions);
  CHECK(present.normals == expected.normals);
  CHECK(present.colors == expected.colors);
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEndInCore,
                  "points that vanish at once are not felt, and appear again as strokes have left them") {
  const Scene scene = makeScene("sphere", 8'000);
  const BrushOptions push{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8};
  const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = push});
  Hand hand(*touch, scene.cloud);
  CHECK(hand.press(1) > 0.2);
  const std::vector<PointState> dented(hand.states().begin(), hand.states().end());
  REQUIRE(dented.size() > scene.cloud.size());  // the stroke has inserted points
  PointSet top = above(dented, 20);
  REQUIRE(touch->edits()->replace(top, dented, top));
  CHECK(hand.follow() == 0);  // nothing of it is reported
  CHECK(hand.press(1) == 0);
  CHECK(hand.press(-1) > 0.2);  // the bottom is there, and yields
  std::vector<PointState> now(hand.states().begin(), hand.states().end());
  std::size_t changed = 0;
  top.forEach([&](std::uint64_t point) { changed += !isSameToTheBit(now[point], dented[point]); });
  CHECK(changed == 0);
  for (PointState& state : now) state.gone |= top.test(state.number);
  checkHas(*touch, scene.cloud, now);
  // Points that a stroke has inserted meanwhile are not in the set.
  REQUIRE(touch->edits()->replace(top, hand.states(), {}));
  checkHas(*touch, scene.cloud, hand.states());
  CHECK(hand.press(1) > 0.2);
  while (hand.undo()) hand.follow();
  checkHas(*touch, scene.cloud, hand.states());
  for (std::size_t i = 0; i < scene.cloud.size(); ++i)
    if (hand.states()[i].position != scene.cloud.positions[i]) ++changed;
  CHECK(changed == 0);
}

TEST_CASE_FIXTURE(OnBackEndInCore, "all points and single ones are replaced at once, at sizes beside powers of two") {
  for (const std::size_t count : {1U, 63U, 64U, 65U, 1000U}) {
    CAPTURE(count);
    Scene scene = makeScene("sphere", count);
    scene.cloud.colors.assign(count, {90, 80, 70});
    const BrushOptions brush{.yieldDepth = 0.3, .radius = 8};
    const auto touch = make(scene.cloud, {.radius = 6, .brush = brush, .paintable = true});
    touch->edits()->keep();
    std::vector<PointState> states = statesOf(scene.cloud);
    const PointSet all = PointSet::range(0, count);
    REQUIRE(touch->edits()->replace(all, states, all));
    CHECK_FALSE(touch->query({.time_s = 0.001, .hip = {0, 0, 49}}, 0).touching);
    PointSet last;
    last.set(count - 1);
    REQUIRE(touch->edits()->replace(all, states, last));
    if (count > 1) {
      states.back().gone = true;
      checkHas(*touch, scene.cloud, states);
      states.back().gone = false;
    }
    REQUIRE(touch->edits()->replace(last, states, {}));
    checkHas(*touch, scene.cloud, states);
    for (PointState& state : states) {
      state.position.z += 0.25f * static_cast<float>(1 + state.number % 3);
      state.color = packedColor({1, 2, static_cast<std::uint8_t>(state.number % 200), 255});
    }
    REQUIRE(touch->edits()->replace(all, states, last));
    if (count > 1) {
      states.back().gone = true;
      checkHas(*touch, scene.cloud, states);
    }
    for (PointState& state : states) state.gone = state.number % 3 == 1;
    REQUIRE(touch->edits()->replace(all, states, {}));
    checkHas(*touch, scene.cloud, states);
  }
}

}  // namespace palpate::replace_test
