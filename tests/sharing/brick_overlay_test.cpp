// Local edits over received bricks, against a model that keeps each point separately.
#include "haptics/sharing/brick_overlay.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "tests/sharing/brick_hand.hpp"

namespace palpate::brick_overlay_test {

namespace {

constexpr std::uint32_t kPoints = 60;
constexpr int kSide = 3;  // bricks of edge 1 along each axis

using Points = std::vector<PointState>;

PointState randomPoint(std::mt19937& random, std::uint32_t id) {
  std::uniform_real_distribution<float> place(0, kSide);
  PointState point{.number = id, .normal = Vec3(0, 0, 1), .parent = id};
  for (int axis = 0; axis < 3; ++axis) point.position[axis] = place(random);
  point.color = static_cast<std::uint32_t>(random() | 1);
  if (random() % 8 == 0) point.gone = true;
  return point;
}

/// A reference model: per point its last received state, and the local edit until it is settled.
struct World {
  explicit World(unsigned seed) : random(seed) {
    for (std::uint32_t i = 0; i < kPoints; ++i) theirs.push_back(randomPoint(random, i));
    came.resize(kPoints);
    own.resize(kPoints);
    isNew.resize(kPoints);
    BrickBox{IVec3(0), IVec3(kSide - 1)}.forEach([&](const IVec3& at) { keys.push_back(BrickGrid::keyOf(at)); });
  }
  PointState shownOf(std::uint32_t id) const { return own[id] ? *own[id] : theirs[id]; }

  std::mt19937 random;
  BrickGrid grid{1};
  BrickOverlay overlay{grid};
  std::vector<BrickKey> keys;
  std::shared_ptr<const Brick> shown(BrickKey key) const {
    const auto there = stored.find(key);
    return overlay.shown(key, there == stored.end() ? nullptr : there->second);
  }
  BrickOverlay::Bricks stored;
  Points theirs;  // the server's points; all known bricks are up to date after each step
  std::vector<std::optional<PointState>> came, own;
  std::vector<bool> isNew;
};

// A step of a correct server: sends all known bricks that changed, and some bricks are added or dropped.
void step(World& world) {
  Points next = world.theirs;
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t id = world.random() % kPoints;
    next[id] = randomPoint(world.random, id);
  }
  // The server may have applied some of the edits it received, and other clients may have changed those points since.
  std::vector<std::uint32_t> settled;
  for (std::uint32_t id = 0; id < kPoints; ++id) {
    if (!world.own[id] || world.random() % 3 != 0) continue;
    settled.push_back(id);  // of earlier edits; edits made since then stay
    if (!world.isNew[id] && world.random() % 2 == 0) next[id] = *world.own[id];
  }
  const BricksOf before(world.theirs, world.grid), bricks(next, world.grid);
  for (const BrickKey key : world.keys) {
    const bool isKnown = world.stored.contains(key);
    if (isKnown && world.random() % 10 == 0) {
      world.overlay.come(key, nullptr);
      world.stored.erase(key);
      continue;
    }
    const auto brick = bricks.at(key);
    if (isKnown ? *brick == *before.at(key) : world.random() % 4 != 0) continue;
    world.overlay.come(key, brick.get());
    world.stored[key] = brick;
  }
  world.theirs = next;
  world.overlay.settle(settled);
  for (const std::uint32_t id : settled)
    if (!world.isNew[id]) world.own[id].reset();
}

void makeSome(World& world) {
  std::vector<PointChange> changes;
  for (std::uint32_t id = 0; id < kPoints; ++id) {
    const PointState from = world.shownOf(id);
    // A hand can only edit points of known bricks.
    if (from.gone || !world.stored.contains(world.grid.keyAt(DVec3(from.position))) || world.random() % 6 != 0)
      continue;
    const PointState to = randomPoint(world.random, id);
    changes.push_back({.from = from, .to = to});
    world.own[id] = to;
    world.isNew[id] = true;
  }
  BrickOverlay::Bricks shown;
  for (const auto& [key, brick] : world.stored) shown[key] = world.shown(key);
  world.overlay.make(changes, shown, BrickOverlay::Replaces::any);
}

}  // namespace

TEST_CASE("local edits are shown over received bricks until the server has them, and changed bricks are reported") {
  std::size_t shown = 0, own = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    World world(seed);
    std::map<BrickKey, Brick> seen;
    for (int turn = 0; turn < 60; ++turn) {
      step(world);
      if (turn % 2 == 0) makeSome(world);
      if (world.random() % 3 == 0) {
        std::vector<sharing::MadeState> made;
        world.overlay.takeMade(made);
        std::size_t fresh = 0;
        for (const auto& [state, replaced] : made) {
          CHECK_FALSE(replaced);
          REQUIRE(world.isNew[state.number]);
          CHECK(*world.own[state.number] == state);
        }
        for (std::uint32_t id = 0; id < kPoints; ++id) fresh += world.isNew[id];
        CHECK(made.size() == fresh);
        world.isNew.assign(kPoints, false);
      }
      Points all;
      for (std::uint32_t id = 0; id < kPoints; ++id) all.push_back(world.shownOf(id));
      const BricksOf expected(all, world.grid);
      const std::set<BrickKey> touched = world.overlay.takeTouched();
      for (const BrickKey key : world.keys) {
        const auto brick = world.shown(key);
        REQUIRE((brick != nullptr) == world.stored.contains(key));
        const Brick now = brick ? *brick : Brick();
        if (brick) CHECK(now == *expected.at(key));
        if (!touched.contains(key)) CHECK(now == seen[key]);
        seen[key] = now;
        shown += now.size();
      }
      own += world.overlay.own();
      CHECK(world.overlay.own() == static_cast<std::size_t>(std::ranges::count_if(
                                       world.own, [](const auto& each) { return each.has_value(); })));
    }
  }
  CHECK(shown > 10'000);
  CHECK(own > 10'000);
}

TEST_CASE("a source shows local edits in its next frame, reports their version and changes nothing else") {
  BrickSource source({.edge = 1, .points = 100});
  Points points;
  for (std::uint32_t i = 0; i < 10; ++i)
    points.push_back({.position = Vec3(0.1f * static_cast<float>(i) + 0.05f, 0.5f, 0.5f),
                      .number = i,
                      .normal = Vec3(0, 0, 1),
                      .color = 7,
                      .parent = i});
  const BrickKey first = BrickGrid::keyOf(IVec3(0)), second = BrickGrid::keyOf(IVec3(1, 0, 0));
  const auto both = [&](const Points& of) {
    const BricksOf bricks(of, source.grid());
    return BrickUpdate{.bricks = {{first, bricks.block(first)}, {second, bricks.block(second)}}};
  };
  const BrickUpdate update = both(points);
  source.apply(update);
  CloudFrame before, after;
  source.makeFrame(1, before);
  PointState moved = points[3];
  moved.position.x = 1.5f;
  PointState gone = points[5];
  gone.gone = true;
  const std::uint64_t version =
      source.make(std::vector<PointChange>{{.from = points[3], .to = moved}, {.from = points[5], .to = gone}});
  CHECK(source.versionOf(before.time_s) < version);
  CHECK(source.hasNewer(2, 1));
  source.makeFrame(2, after);
  CHECK(source.versionOf(after.time_s) == version);
  REQUIRE(before.size() == 10);
  REQUIRE(after.size() == 9);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const std::size_t then = i < 5 ? i : i + 1;
    CHECK(after.positions[i] == (i == 3 ? moved.position : before.positions[then]));
  }
  Points there;
  source.pointsIn(DVec3(1), DVec3(2), there);
  CHECK(there.empty());
  source.pointsIn(DVec3(1, 0, 0), DVec3(2, 1, 1), there);
  REQUIRE(there.size() == 1);
  CHECK(there[0] == moved);
  CHECK(source.known().own == 2);
  // A brick received without the edits changes nothing; once the edits are settled, bricks are shown as received.
  source.apply(update);
  CHECK(source.known().points == 9);
  CHECK(madeStates(source) == Points{moved, gone});
  Points theirs = points;
  theirs[3] = moved;
  theirs[3].position.y = 0.25f;  // another client has changed it since
  theirs[5] = gone;
  BrickUpdate last = both(theirs);
  last.settled = {3, 5};
  source.apply(last);
  there.clear();
  source.pointsIn(DVec3(0), DVec3(2), there);
  REQUIRE(there.size() == 9);
  CHECK(there.back() == theirs[3]);
  CHECK(source.known().own == 0);
}

TEST_CASE("a point received in another brick while it is edited exists once") {
  const BrickGrid grid(1);
  const BrickKey first = BrickGrid::keyOf(IVec3(0)), second = BrickGrid::keyOf(IVec3(1, 0, 0)),
                 third = BrickGrid::keyOf(IVec3(2, 0, 0));
  const auto at = [](float x) {
    return PointState{.position = Vec3(x, 0.5f, 0.5f), .number = 4, .normal = Vec3(0, 0, 1), .color = 1, .parent = 4};
  };
  BrickOverlay overlay(grid);
  BrickOverlay::Bricks stored;
  const auto come = [&](BrickKey key, std::shared_ptr<const Brick> brick) {
    overlay.come(key, brick.get());
    stored[key] = std::move(brick);
  };
  const auto shown = [&](BrickKey key) { return overlay.shown(key, stored.at(key))->size(); };
  come(first, BricksOf(Points{at(0.5f)}, grid).at(first));
  for (const BrickKey key : {second, third}) come(key, std::make_shared<Brick>());
  // Another client moves the point after a hand has read it.
  come(first, std::make_shared<Brick>());
  come(second, BricksOf(Points{at(1.5f)}, grid).at(second));
  overlay.takeTouched();
  overlay.make(std::vector<PointChange>{{.from = at(0.5f), .to = at(2.5f)}}, stored, BrickOverlay::Replaces::any);
  CHECK(overlay.takeTouched() == std::set<BrickKey>{second, third});
  CHECK(shown(first) == 0);
  CHECK(shown(second) == 0);
  CHECK(shown(third) == 1);
  std::vector<sharing::MadeState> made;
  overlay.takeMade(made);
  overlay.settle(std::vector<std::uint32_t>{4});
  CHECK(overlay.takeTouched().contains(second));
  CHECK(shown(second) == 1);
}

}  // namespace palpate::brick_overlay_test
