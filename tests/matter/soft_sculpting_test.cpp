// Soft bodies whose rest shape a brush changes, on the CPU.
#include "engine/matter/soft_sculpture.hpp"
#include "tests/history_steps.hpp"
#include "tests/labels.hpp"
#include "tests/matter/soft_on_cpu.hpp"
#include "tests/near.hpp"

namespace palpate::soft_sculpting_test {

namespace {

// With a brush that leaves the yield depth of the distance to the hand.
SoftTouching withBrush(BrushKind kind, double radius = 12) {
  SoftTouching options;
  options.touch.brush = BrushOptions{.kind = kind, .yieldDepth = 0.5, .pushRate = 0.1, .radius = radius};
  return options;
}

std::vector<Vec3> shapeOf(const SoftScene& scene) {
  const std::span<const Vec3> rest =
      const_cast<MatterSimulation&>(scene.world()).sculpture()->body().rest().displacements();
  return {rest.begin(), rest.end()};
}

// Mean height of the points at this distance from the centre of the top.
double topOf(SoftScene& scene, float from = 0, float to = 3) {
  const PointCloud now = scene.points();
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3& began = scene.cloud().positions[i];
    const float away = glm::length(glm::vec2(began.x - 50, began.z - 50));
    if (began.y < 39.9f || away < from || away > to) continue;
    sum += static_cast<double>(now.positions[i].y);
    ++count;
  }
  return sum / count;
}

// From 4 above down to `y`, then at rest; `time_s` advances. Returns the last answer.
Contact goDown(SoftScene& scene, double& time_s, double y, int ticks, double x = 50) {
  Contact last;
  for (int k = 0; k < ticks; ++k, time_s += 1e-3)
    last = scene.touch().query({.time_s = time_s, .hip = {x, y + 4 * std::max(0.0, 1 - 2.0 * k / ticks), 50}}, 0);
  return last;
}

void wait(SoftScene& scene, double& time_s, int ticks) {
  for (int k = 0; k < ticks; ++k, time_s += 1e-3) scene.touch().query({.time_s = time_s, .hip = {50, 60, 50}}, 0);
}

}  // namespace

TEST_CASE("a pushed dent remains after the hand has left, less the elastic part" * kFull) {
  SoftScene block = touched(bareBlock(), withBrush(BrushKind::push));
  double time_s = 0;
  wait(block, time_s, 600);
  const double top = topOf(block), deep = top - 6;
  FeltSpring spring({.stiffness_N_per_unit = 0.5, .damping_N_s_per_unit = 0, .most_N = 5});
  const Contact held = goDown(block, time_s, deep, 2500);
  REQUIRE(held.touching);
  // It has yielded until the tip of the brush's ball is the yield depth above the hand. The averaged surface, which
  // holds the spring, is above that tip in a dent as round as the ball, by at most its bias for a ball, less in a wider
  // dent. So the spring is stretched by the yield depth and a part of that bias, and its force is its stiffness times
  // that.
  const DVec3 force = spring.add(held, {50, deep, 50}, 1e-3);
  const double stretch = held.proxy.y - deep;
  CHECK(stretch > 0.5);
  CHECK(stretch < 0.5 + averageSurfaceBias(block.radius(), 12));
  CHECK(force.y == near(0.5 * stretch, 0.01));
  auto& world = const_cast<MatterSimulation&>(block.world());
  const double elastic_mm =
      1e3 * world.localCompliance_m_N(1e-3 * held.proxy, 0.5e-3 * block.radius(), {0, -1, 0}) * force.y;
  wait(block, time_s, 1500);
  const double dent = top - topOf(block);
  MESSAGE("dent of " << dent << " mm by a hand 6 mm deep; the spring has " << stretch << ", elastic " << elastic_mm);
  CHECK(dent == near(6 - stretch - elastic_mm, 0.1));
  // No contact inside the dent, contact at its bottom.
  CHECK_FALSE(goDown(block, time_s, top - 3, 300).touching);
  CHECK(goDown(block, time_s, top - 6, 300).touching);
  CHECK(ShapeHistory(*block.touch().shapeStrokes()).counts().strokes == 1);
}

TEST_CASE("a brush changes the rest shape only within its reach, and undo and redo restore it bit by bit") {
  SoftScene block = touched(bareBlock(), withBrush(BrushKind::push, 7));
  double time_s = 0;
  wait(block, time_s, 300);
  const std::vector<Vec3> none(shapeOf(block).size(), Vec3(0));
  CHECK(shapeOf(block) == none);
  const double began = topOf(block);
  goDown(block, time_s, began - 4, 600);
  wait(block, time_s, 400);
  // A permanent dent without contact inside.
  CHECK(began - topOf(block) > 1);
  CHECK_FALSE(goDown(block, time_s, began - 1, 100).touching);
  const std::vector<Vec3> first = shapeOf(block);
  const SoftLattice& lattice = const_cast<MatterSimulation&>(block.world()).sculpture()->body().lattice();
  double most = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double away = glm::distance(1e3 * DVec3(lattice.rest()[i]), DVec3(50, 40, 50));
    if (away > 7 + 4 + 2 * 5 + 1) CHECK(first[i] == Vec3(0));
    most = std::max(most, static_cast<double>(-first[i].y));
  }
  CHECK(most > 1e-3);
  goDown(block, time_s, began - 3, 600, 38);
  wait(block, time_s, 300);
  const std::vector<Vec3> second = shapeOf(block);
  CHECK(second != first);
  const double dented = topOf(block);
  ShapeHistory strokes(*block.touch().shapeStrokes());
  CHECK(strokes.counts().strokes == 2);
  CHECK(strokes.counts().undoCount == 2);
  CHECK(strokes.undo());
  CHECK(shapeOf(block) == first);
  CHECK(strokes.undo());
  CHECK(shapeOf(block) == none);
  // Its points have moved before the next query.
  CHECK(topOf(block) - dented > 1);
  CHECK_FALSE(strokes.undo());
  CHECK(strokes.counts().redoCount == 2);
  wait(block, time_s, 800);
  CHECK(std::abs(topOf(block) - began) < 0.05);
  CHECK(strokes.redo());
  CHECK(shapeOf(block) == first);
  CHECK(strokes.counts().version == 1);
}

TEST_CASE("a soft body receives the force that the hand feels also while it yields to a brush") {
  SoftScene block = touched(bareBlock(), withBrush(BrushKind::push));
  FeltSpring spring({.stiffness_N_per_unit = 0.5, .damping_N_s_per_unit = 0.002, .most_N = 5});
  DVec3 felt(0);
  for (int k = 0; k < 900; ++k) {
    const Pose pose = press(1e-3 * k, 5, 0.5);
    felt += 1e-3 * spring.add(block.touch().query(pose, 0), pose.hip, 1e-3);
  }
  const MatterImpulses& given = block.world().impulses();
  CHECK(felt.y > 0.1);
  // The hand feels the body after the tick's yielding, and the body gets the force before it.
  CHECK(std::abs(given.onTools.y - felt.y) < 0.04 * felt.y);
  const DVec3 missing = block.world().totals().momentum - (given.gravity - given.onWalls - given.onTools);
  CHECK(glm::length(missing) <= 1e-5 * (glm::length(given.gravity) + glm::length(given.onTools)));
}

TEST_CASE("inflate, smooth, grab and flatten work on a soft body, the same bit by bit for any number of threads" *
          kMoreInFull) {
  const int rest = byTier(100, 300), held = byTier(550, 700);
  for (const BrushKind kind : {BrushKind::inflate, BrushKind::smooth, BrushKind::grab, BrushKind::flatten}) {
    CAPTURE(static_cast<int>(kind));
    if (!inFullTier() && kind == BrushKind::inflate) continue;  // it makes the hill that others remove
    SoftTouching options = withBrush(kind, 14);
    options.touch.brush->yieldDepth = 0.2;
    SoftScene block = touched(bareBlock(), options);
    options.threads = 1;
    SoftScene same = touched(bareBlock(), options);
    double time_s = 0;
    wait(block, time_s, rest);
    const double began = topOf(block);
    if (kind == BrushKind::smooth || kind == BrushKind::flatten) {
      block.touch().setBrush(withBrush(BrushKind::inflate, 8).touch.brush);  // makes a hill
      goDown(block, time_s, began - 1.5, byTier(700, 1500));
      wait(block, time_s, rest);
      block.touch().setBrush(options.touch.brush);
    }
    const double hill = topOf(block) - began, over = topOf(block) - topOf(block, 7, 10);
    for (int k = 0; k < held; ++k, time_s += 1e-3) {
      const double along = kind == BrushKind::grab ? 6 * std::max(0.0, k / static_cast<double>(held) - 0.3) : 0;
      block.touch().query(
          {.time_s = time_s, .hip = {50 + along, began + hill - 1.5 + 3 * std::max(0.0, 1 - k / 200.0), 50}}, 0);
    }
    wait(block, time_s, byTier(150, 800));
    const double after = topOf(block) - began;
    if (kind == BrushKind::inflate) CHECK(after > 0.3);
    if (kind == BrushKind::smooth || kind == BrushKind::flatten) {
      CHECK(over > 0.5);
      CHECK(topOf(block) - topOf(block, 7, 10) < 0.8 * over);
    }
    if (kind == BrushKind::grab) {
      double along = 0;
      for (const Vec3& node : shapeOf(block)) along = std::max(along, static_cast<double>(node.x));
      CHECK(along > 1e-3);
    }
    if (!inFullTier() && kind != BrushKind::grab) continue;
    double again_s = 0;
    wait(same, again_s, rest);
    const auto play = [&](SoftScene& scene, double begin_s) {
      for (int k = 0; k < byTier(60, 200); ++k)
        scene.touch().query({.time_s = begin_s + 1e-3 * k, .hip = {50, 42 - 4.0 * k / byTier(60, 200), 50}}, 0);
    };
    options.threads = 3;
    SoftScene other = touched(bareBlock(), options);
    double other_s = 0;
    wait(other, other_s, rest);
    play(same, again_s);
    play(other, other_s);
    CHECK(shapeOf(same) == shapeOf(other));
  }
}

}  // namespace palpate::soft_sculpting_test
