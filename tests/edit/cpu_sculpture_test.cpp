// Sculpting on the CPU at the cost of the touched points: its index and its lists against fresh ones, and its sums
// against those of neighbours one by one. Random edits are as many as the tier says, or for a given time:
// PALPATE_EDITS_S=3600 PALPATE_EDITS_SEED=7
#include "engine/edit/cpu_sculpture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>
#include <random>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/clock.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/resample.h"
#include "tests/edit/tool_at.hpp"
#include "tests/labels.hpp"

namespace palpate::cpu_sculpture_test {

namespace {

constexpr double kShapeRadius = 50;  // of the sphere, model units

PointCloud ballOf(std::size_t count) { return sampleShape(*makeShape("sphere", 2 * kShapeRadius), {.count = count}); }

double supportFor(std::size_t count) {
  return 4 * kShapeRadius * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
}

CpuSculpture sculptureOf(const PointCloud& cloud, unsigned threads, IndexFollow index = IndexFollow::incremental) {
  const double radius = supportFor(cloud.size());
  return {cloud,
          makeHashGrid(Vec3(-kShapeRadius), radius, cloud.size()),
          {.radius = radius, .index = index, .threads = threads}};
}

void checkIndex(const CpuSculpture& sculpture) {
  SortedGrid fresh(sculpture.grid().grid(), 1);
  fresh.build(sculpture.points().positions, sculpture.points().there);
  REQUIRE(sculpture.grid().size() == fresh.size());
  std::size_t wrong = 0;
  for (std::uint32_t b = 0; b <= fresh.grid().bucketMask; ++b)
    wrong += !std::ranges::equal(sculpture.grid().bucket(b), fresh.bucket(b),
                                 [](const SortedGrid::Placed& one, const SortedGrid::Placed& other) {
                                   return one.number == other.number && one.position == other.position;
                                 });
  REQUIRE(wrong == 0);
}

// Edits of every kind at random places, now and then undone.
class RandomSculpting {
 public:
  RandomSculpting(CpuSculpture& sculpture, double radius, std::uint32_t seed)
      : sculpture_(sculpture), radius_(radius), random_(seed) {}

  std::size_t removed() const { return removed_; }
  void one() {
    const BrushOptions brush{
        .kind = kBrushes[pick(kBrushes.size())].kind, .yieldDepth = 0.5, .pushRate = 0.5, .radius = 4.0 + pick(20)};
    const std::uint32_t under = pick(2000);
    if (pick(4) == 0) crowd(under);  // so that points merge
    const DVec3 outward = glm::normalize(DVec3(sculpture_.points().positions[under]));
    const double depth = 0.5 + 3 * std::abs(share());
    const PlacedBrush placed = brushAt(brush, radius_, (kShapeRadius - depth) * outward, depth * outward);
    for (std::uint32_t tick = 0; tick < 3; ++tick) {
      note();
      sculpture_.edit(placed, pick(3) == 0 ? EditSize::tick : EditSize::whole);
      checkIndex(sculpture_);
      removed_ += static_cast<std::size_t>(std::ranges::count_if(
          sculpture_.changed(), [&](std::uint32_t point) { return !sculpture_.points().there[point]; }));
    }
    if (pick(3) == 0) undo();
  }

 private:
  std::uint32_t pick(std::size_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, static_cast<std::uint32_t>(n) - 1)(random_);
  }
  double share() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  void crowd(std::uint32_t under) {
    std::vector<PointChange> changes;
    for (std::uint32_t i = under + 1; i < under + 6; ++i) {
      changes.push_back({sculpture_.points().state(i), sculpture_.points().state(under)});
      changes.back().to.number = i;
      changes.back().to.parent = i;
    }
    sculpture_.set(changes);
    checkIndex(sculpture_);
  }
  void note() {
    before_.clear();
    for (std::uint32_t i = 0; i < sculpture_.points().size(); ++i) before_.push_back(sculpture_.points().state(i));
  }
  // The last tick: its new points are removed.
  void undo() {
    std::vector<PointChange> changes;
    for (std::uint32_t i = 0; i < sculpture_.points().size(); ++i) {
      const PointState now = sculpture_.points().state(i);
      PointState then = now;
      if (i < before_.size())
        then = before_[i];
      else
        then.gone = true;
      if (!(then == now)) changes.push_back({now, then});
    }
    sculpture_.set(changes);
    checkIndex(sculpture_);
    CHECK(sculpture_.settled());
  }

  CpuSculpture& sculpture_;
  double radius_;
  std::mt19937 random_;
  std::vector<PointState> before_;
  std::size_t removed_ = 0;
};

}  // namespace

TEST_CASE("whatever is sculpted and undone, the CPU's points and index are those of fresh builds" * kMoreInFull) {
  const PointCloud cloud = ballOf(3000);
  const double radius = supportFor(cloud.size());
  CpuSculpture sculpture = sculptureOf(cloud, 1), rebuilt = sculptureOf(cloud, 3, IndexFollow::rebuild);
  const char* const named = std::getenv("PALPATE_EDITS_SEED");
  const auto seed = static_cast<std::uint32_t>(named ? std::atoi(named) : 8);
  RandomSculpting random(sculpture, radius, seed), same(rebuilt, radius, seed);
  const Stopwatch watch;
  const char* const given = std::getenv("PALPATE_EDITS_S");
  for (int edit = 0; given ? watch.elapsed_s() < std::atof(given) : edit < byTier(100, 3000); ++edit) {
    CAPTURE(edit);
    random.one();
    same.one();
    REQUIRE(sculpture.points().positions == rebuilt.points().positions);
    REQUIRE(sculpture.points().normals == rebuilt.points().normals);
    REQUIRE(sculpture.points().there == rebuilt.points().there);
  }
  CHECK(sculpture.followed() > 10);
  CHECK(sculpture.points().size() > cloud.size());
  CHECK(random.removed() > 0);
}

TEST_CASE("the normals of sculpted points are those of their neighbours one by one, bit by bit") {
  const PointCloud cloud = ballOf(20'000);
  const double radius = supportFor(cloud.size());
  CpuSculpture sculpture = sculptureOf(cloud, 2);
  BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 5, .resample = false};
  std::size_t refitted = 0;
  for (int tick = 0; tick < 10; ++tick) {
    const std::vector<Vec3> before = sculpture.points().normals, places = sculpture.points().positions;
    sculpture.edit(brushAt(push, radius, DVec3(0, 0, 44), DVec3(0, 0, 6)));
    const SculptedPoints& points = sculpture.points();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (points.positions[i] == places[i]) continue;
      const DVec3 place(points.positions[i]);
      NormalFit fit(radius);
      DVec3 side(0);
      sculpture.grid().forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
        const double share{shared::fitShare(glm::dot(before[near.number], before[i]))};
        const DVec3 offset = DVec3(near.position) - place;
        fit.add(offset, share);
        side += share * wendland(glm::length(offset) / radius) * DVec3(before[near.number]);
      });
      const DVec3 normal = fit.normal(DVec3(before[i])).normal;
      REQUIRE(points.normals[i] == Vec3(glm::dot(normal, side) < 0 ? -normal : normal));
      ++refitted;
    }
  }
  CHECK(refitted >= 500);
}

TEST_CASE("points that wait for their turn in a stroke have it, though changes of others are received meanwhile") {
  const PointCloud cloud = ballOf(60'000);
  const double radius = 1.5 * supportFor(cloud.size());
  const HashGrid grid = makeHashGrid(Vec3(-kShapeRadius), radius, cloud.size());
  const BrushOptions push{.yieldDepth = 0.5, .pushRate = 0.3, .radius = 12, .resample = false};
  const PlacedBrush down = brushAt(push, radius, DVec3(0, 0, 44), DVec3(0, 0, 6));
  CpuSculpture alone(cloud, grid, {.radius = radius, .threads = 1}), joined(cloud, grid, {.radius = radius});
  std::uint32_t far = 0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].z < cloud.positions[far].z) far = i;
  std::size_t waited = 0;
  for (int tick = 0; tick < 40; ++tick) {
    alone.edit(down, EditSize::tick);
    joined.edit(down, EditSize::tick);
    waited += joined.someWait();
    PointState painted = joined.points().state(far);
    painted.color = 0xff000000u + static_cast<std::uint32_t>(tick);
    joined.receive(std::array{PointChange{.from = joined.points().state(far), .to = painted}});
  }
  CHECK(waited > 20);
  CHECK(joined.points().colors[far] == 0xff000027u);
  CHECK(joined.points().positions == alone.points().positions);
  CHECK(joined.points().normals == alone.points().normals);
}

TEST_CASE("an edit for a tick refits few points, the furthest moved first, and the rest follows to the same surface") {
  const PointCloud cloud = ballOf(60'000);
  const double radius = 1.5 * supportFor(cloud.size());
  const HashGrid grid = makeHashGrid(Vec3(-kShapeRadius), radius, cloud.size());
  const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 12};
  const PlacedBrush down = brushAt(push, radius, DVec3(0, 0, 44), DVec3(0, 0, 6));
  CpuSculpture whole(cloud, grid, {.radius = radius}), parts(cloud, grid, {.radius = radius, .threads = 1}),
      same(cloud, grid, {.radius = radius, .threads = 3});
  std::size_t mostMoved = 0, mostRefitted = 0, waited = 0;
  const auto edit = [&](const PlacedBrush& brush) {
    const std::vector<Vec3> before = parts.points().normals;
    whole.edit(brush);
    parts.edit(brush, EditSize::tick);
    same.edit(brush, EditSize::tick);
    mostMoved = std::max(mostMoved, whole.changed().size());
    std::size_t refitted = 0;
    for (std::size_t i = 0; i < before.size(); ++i) refitted += parts.points().normals[i] != before[i];
    mostRefitted = std::max(mostRefitted, refitted);
    waited += parts.backlog().waits;
    REQUIRE(parts.points().positions == same.points().positions);
    REQUIRE(parts.points().normals == same.points().normals);
  };
  for (int tick = 0; tick < 60; ++tick) edit(down);
  CHECK(mostMoved > 600);
  CHECK(waited > 30);
  CHECK(mostRefitted > 100);
  CHECK(mostRefitted < 320);
  CHECK(parts.backlog().strain < 1);
  // Without the brush the others follow.
  BrushStroke none(radius);
  none.setBrush(push);
  const PlacedBrush rest(push, radius, none.next(0.1));
  int ticks = 0;
  while (!parts.settled() && ticks++ < 400) edit(rest);
  CHECK(parts.settled());
  CHECK_FALSE(parts.backlog().waits);
  const PointTree tree(whole.points().positions);
  std::vector<std::uint32_t> near;
  double turned = 0, farthest = 0;
  for (std::uint32_t i = 0; i < parts.points().size(); ++i) {
    if (!parts.points().there[i] || parts.points().positions[i] == whole.points().positions[i]) continue;
    near.clear();
    tree.near(DVec3(parts.points().positions[i]), radius, near);
    REQUIRE_FALSE(near.empty());
    const auto nearest = std::ranges::min(near, {}, [&](std::uint32_t k) {
      return glm::distance(parts.points().positions[i], whole.points().positions[k]);
    });
    farthest =
        std::max(farthest, double{glm::distance(parts.points().positions[i], whole.points().positions[nearest])});
    turned += double{glm::dot(parts.points().normals[i], whole.points().normals[nearest])} < 0.9;
  }
  CHECK(farthest < 0.5 * radius);
  CHECK(turned < 0.01 * static_cast<double>(mostMoved));
}

TEST_CASE("thousands of coincident points under a brush cost no edit more than its share, and become few") {
  constexpr std::size_t kHeap = 5'000;
  PointCloud cloud = ballOf(20'000);
  const double radius = supportFor(cloud.size());
  cloud.positions.insert(cloud.positions.end(), kHeap, Vec3(0, 0, kShapeRadius));
  cloud.normals.insert(cloud.normals.end(), kHeap, Vec3(0, 0, 1));
  const HashGrid grid = makeHashGrid(Vec3(-kShapeRadius), radius, cloud.size());
  const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 8};
  const PlacedBrush beside = brushAt(push, radius, DVec3(0, 47, 0), DVec3(0, 3, 0)),
                    onto = brushAt(push, radius, DVec3(0, 0, 48), DVec3(0, 0, 2));
  BrushStroke none(radius);
  none.setBrush(push);
  const PlacedBrush rest(push, radius, none.next(0.1));
  for (const EditSize size : {EditSize::tick, EditSize::whole}) {
    CAPTURE(size == EditSize::tick);
    CpuSculpture sculpture(cloud, grid, {.radius = radius, .threads = 1});
    const auto& points = sculpture.points();
    const auto heap = [&] {
      return static_cast<std::size_t>(std::count(points.there.begin() + 20'000, points.there.begin() + 25'000, 1));
    };
    for (int tick = 0; tick < 5; ++tick) sculpture.edit(beside, size);  // where points have few neighbours
    std::size_t mostWork = 0;
    int edits = 0;
    for (; edits < 400 && (edits == 0 || !sculpture.settled()); ++edits) {
      const std::vector<std::uint8_t> before(points.unsettled.begin(), points.unsettled.end());
      const std::size_t around = heap();
      sculpture.edit(edits == 0 ? onto : rest, size);
      std::size_t done = 0;
      for (std::size_t i = 20'000; i < 25'000; ++i) done += (edits == 0 || before[i]) && !points.unsettled[i];
      mostWork = std::max(mostWork, done * around);
    }
    CHECK(sculpture.settled());
    CHECK(heap() < 20);
    CHECK(mostWork > 0);
    CHECK(mostWork < (size == EditSize::tick ? 150'000 : 2'500'000));
  }
}

// A ball with a support radius of sixteen spacings, as dense parts of an uneven scan have: the normal fits of 804
// neighbours each, where a neighbourhood of half a support radius has 201.
TEST_CASE("points of a dense part see as many neighbours as eight spacings hold, also to be smoothed") {
  const PointCloud cloud = ballOf(40'000);
  const double radius = 4 * supportFor(cloud.size());
  for (const BrushKind kind : {BrushKind::push, BrushKind::smooth}) {
    CAPTURE(kind);
    CpuSculpture sculpture(cloud, makeHashGrid(Vec3(-kShapeRadius), radius, cloud.size()),
                           {.radius = radius, .threads = 1});
    const BrushOptions brush{.kind = kind, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 6};
    sculpture.edit(brushAt(brush, radius, DVec3(0, 0, 48), DVec3(0, 0, 2)));
    const auto changed = static_cast<double>(sculpture.changed().size());
    CHECK(changed > 50);
    const double looks = kind == BrushKind::smooth ? 2 : 1;
    CHECK(sculpture.work() > 192 * changed);
    CHECK(sculpture.work() < (512 + looks * 300) * changed);
  }
}

TEST_CASE("a new point copies no array of a sculpture, and no edit of a few points builds the index") {
  const PointCloud cloud = ballOf(60'000);
  CpuSculpture sculpture = sculptureOf(cloud, 1);
  const double radius = supportFor(cloud.size());
  const Vec3* const positions = sculpture.points().positions.data();
  const auto* const founds = sculpture.points().founds.data();
  const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 5};
  for (int tick = 0; tick < 60; ++tick) sculpture.edit(brushAt(push, radius, DVec3(0, 0, 44), DVec3(0, 0, 6)));
  CHECK(sculpture.points().size() > cloud.size() + 20);
  CHECK(sculpture.points().positions.data() == positions);
  CHECK(sculpture.points().founds.data() == founds);
  CHECK(sculpture.rebuilds() == 0);
  CHECK(sculpture.followed() >= 40);
  CHECK(sculpture.grid().written() < 60u * 1000u);
}

TEST_CASE("a push at rest engages as many threads as the points under its brush are worth, and none for others") {
  const PointCloud cloud = ballOf(20'000);
  const double radius = supportFor(cloud.size());
  const auto engagedBy = [&](double brushRadius) {
    CpuSculpture sculpture = sculptureOf(cloud, 4);
    const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = brushRadius};
    const PlacedBrush placed = brushAt(push, radius, DVec3(0, 0, 48), DVec3(0, 0, 2));
    std::size_t most = 0;
    for (int tick = 0; tick < 400; ++tick) {
      sculpture.edit(placed);
      most = std::max(most, sculpture.engaged().unsettled);
      if (tick > 0 && sculpture.changed().empty()) break;
    }
    REQUIRE(sculpture.changed().empty());
    CHECK(most > 1);
    sculpture.edit(placed);
    CHECK(sculpture.engaged().unsettled == 1);
    return sculpture.engaged().atFirst;
  };
  CHECK(engagedBy(20) == 4);
  CHECK(engagedBy(4) == 1);
}

}  // namespace palpate::cpu_sculpture_test
