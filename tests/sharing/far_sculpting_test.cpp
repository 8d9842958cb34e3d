// ctest: waits
// Hands that sculpt the points around them, each with only those.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "tests/error_of.hpp"
#include "tests/labels.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::far_sculpting_test {

namespace {

constexpr double kRoom = 12;  // of the area where hands meet, along both sides

/// A hand near its points that edits those around it.
class NearSculptor {
 public:
  explicit NearSculptor(const std::string& name, unsigned seed) : joined_(joinNear(name)), random_(seed) {
    REQUIRE(joined_.far);
    REQUIRE(joined_.far->isSculptable());
  }
  FarCloud& far() const { return *joined_.far; }
  BrickSource& source() const { return joined_.far->source(); }

  bool comesTo(const DVec3& hip) { return palpate::comesTo(hip_ = hip, source()); }
  /// Points within the room.
  std::vector<PointState> points() const {
    std::vector<PointState> points;
    source().pointsIn(hip_ - kRoom / 2, hip_ + kRoom / 2, points);
    std::ranges::sort(points, {}, [](const PointState& point) { return point.number; });
    return points;
  }
  /// Some points are moved, a few removed, in one edit.
  void edit() {
    std::vector<PointChange> changes;
    std::uniform_real_distribution<float> by(-0.4f, 0.4f);
    for (const PointState& from : points()) {
      if (random_() % 5 != 0) continue;
      PointState to = from;
      for (int axis = 0; axis < 3; ++axis) to.position[axis] += by(random_);
      to.color = static_cast<std::uint32_t>(random_());
      if (random_() % 40 == 0) to.gone = true;
      changes.push_back({.from = from, .to = to});
    }
    source().make(changes);
  }

 private:
  JoinedCloud joined_;
  std::mt19937 random_;
  DVec3 hip_{0};
};

bool isSamePoint(const PointState& a, const PointState& b) {
  return a.number == b.number && a.gone == b.gone && a.position == b.position && a.normal == b.normal &&
         a.color == b.color;
}

}  // namespace

TEST_CASE("edits of several clients with only nearby points reach the server and each other once") {
  const PointCloud cloud = square();
  Served served(cloud, "sculpted near");
  std::vector<std::vector<PointState>> seen;
  std::uint64_t sent = 0;
  {
    NearSculptor first("sculpted near", 1), second("sculpted near", 2);
    const NearSculptor* const all[] = {&first, &second};
    const DVec3 place(100, 100, 0);
    REQUIRE(first.comesTo(place));
    REQUIRE(second.comesTo(place));
    for (int turn = 0; turn < 40; ++turn) {
      first.edit();
      if (turn % 2 == 0) second.edit();
      std::this_thread::sleep_for(std::chrono::milliseconds(7));
    }
    // Away and back: the edit made far away is unchanged.
    REQUIRE(first.comesTo(DVec3(20, 20, 0)));
    first.edit();
    REQUIRE(first.comesTo(place));
    for (const NearSculptor* hand : all) {
      CHECK(within(30, [&] { return hand->far().counts().delivered; }));
      sent += hand->far().counts().sent;
      CHECK(hand->far().counts().resent == 0);
    }
    CHECK(within(30, [&] {
      first.comesTo(place);
      second.comesTo(place);
      return first.source().known().own + second.source().known().own == 0 &&
             std::ranges::equal(first.points(), second.points(), isSamePoint);
    }));
    for (const NearSculptor* hand : all) seen.push_back(hand->points());
    CHECK_NOTHROW(first.far().check());
  }
  const ServedCounts counts = served.end();
  CHECK(counts.sculptors == 2);
  CHECK(counts.states == sent);
  CHECK(counts.again == 0);
  CHECK(counts.refused == 0);
  // The server's points equal those that the hands have seen, and all others are unchanged.
  const std::vector<PointState> before = statesOf(cloud);
  std::size_t changed = 0, wrong = 0;
  std::map<std::uint32_t, PointState> there;
  for (const PointState& point : seen[0]) there[point.number] = point;
  for (const PointState& point : served.points()) {
    const PointState& old = before[point.number];
    const bool isFar = glm::distance(DVec3(old.position), DVec3(100, 100, 0)) > 20 &&
                       glm::distance(DVec3(old.position), DVec3(20, 20, 0)) > 20;
    changed += !isSamePoint(point, old);
    if (isFar) wrong += !isSamePoint(point, old);
    const auto here = there.find(point.number);
    if (here != there.end()) wrong += !isSamePoint(point, here->second);
    const DVec3 off = glm::abs(DVec3(point.position) - DVec3(100, 100, 0));
    if (here == there.end() && !point.gone) wrong += glm::max(glm::max(off.x, off.y), off.z) < kRoom / 2;
  }
  CHECK(changed > 100);
  CHECK(wrong == 0);
}

TEST_CASE("continuous edits of the same nearby points are acknowledged without a resend" * kClock) {
  const PointCloud cloud = square();
  Served served(cloud, "on and on");
  NearSculptor hand("on and on", 4);
  REQUIRE(hand.comesTo(DVec3(100, 100, 0)));
  // Each point is edited again before the server has acknowledged it.
  const std::vector<PointState> points = hand.points();
  std::vector<PointState> now = points;
  for (const Stopwatch since; since.elapsed_s() < 7; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
    std::vector<PointChange> changes;
    for (PointState& point : now) {
      PointState next = point;
      next.position.z += 1e-4f;
      changes.push_back({.from = point, .to = next});
      point = next;
    }
    hand.source().make(changes);
  }
  CHECK(within(30, [&] { return hand.far().counts().delivered; }));
  CHECK(hand.far().counts().resent == 0);
  CHECK_NOTHROW(hand.far().check());
}

TEST_CASE("edits of nearby points during a server outage are applied once, after it restarts with its journal") {
  const PointCloud cloud = square();
  const ScratchFolder folder;
  const CloudServer::Parts continued{.name = "away", .journal = folder / "strokes"};
  std::optional<Served> served(std::in_place, cloud, continued);
  NearSculptor hand("away", 3);
  const DVec3 place(100, 100, 0);
  REQUIRE(hand.comesTo(place));
  hand.edit();
  CHECK(within(30, [&] { return hand.far().counts().delivered; }));
  served.reset();
  for (int i = 0; i < 5; ++i) hand.edit();
  CHECK_FALSE(within(0.2, [&] { return hand.far().counts().delivered; }));
  const std::vector<PointState> made = hand.points();
  served.emplace(cloud, continued);
  CHECK(within(20, [&] {
    hand.comesTo(place);
    return hand.far().counts().delivered;
  }));
  CHECK(within(30, [&] { return hand.source().known().own == 0; }));
  CHECK(std::ranges::equal(hand.points(), made, isSamePoint));
  CHECK_NOTHROW(hand.far().check());
  const std::uint64_t sent = hand.far().counts().sent;
  served->end();
  std::size_t wrong = 0;
  for (const PointState& point : made) wrong += !isSamePoint(served->points()[point.number], point);
  CHECK(wrong == 0);
  CHECK(served->end().states == sent);
  // A server that restarts without the journal cannot accept this hand's edits.
  served.reset();
  served.emplace(cloud, "away");
  CHECK(within(20, [&] {
    return errorOf([&] { hand.far().check(); }).find("was restarted without its edits") != std::string::npos;
  }));
  CHECK_FALSE(hand.far().known().isTrue());
}

}  // namespace palpate::far_sculpting_test
