// ctest: waits
// Hands near their points undo and redo their strokes, beside others that edit the same points.
#include <doctest/doctest.h>

#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/session/session.hpp"
#include "haptics/sharing/session_joiner.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"
#include "tests/sharing/undoing_hands.hpp"

namespace palpate::far_undo_test {

namespace {

const DVec3 kHere(100, 100, 0), kElsewhere(20, 20, 0);

/// Points of a row of the square around kHere.
std::vector<std::uint32_t> rowOf(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < count; ++i) points.push_back(100 * 200 + 98 + first + i);
  return points;
}

std::unique_ptr<UndoingHand> handOf(const std::string& kind, const std::string& session) {
  if (kind == "whole") return std::make_unique<WholeHand>(session);
  auto hand = std::make_unique<FarHand>(session);
  REQUIRE(hand->comesTo(kHere));
  return hand;
}

/// Whether the hand has these heights of the row, or gets them.
bool gets(UndoingHand& hand, const std::vector<float>& heights) {
  return within(30, [&] {
    hand.follow();
    for (std::uint32_t i = 0; i < heights.size(); ++i)
      if (hand.at(rowOf(i, 1)[0]).position.z != heights[i]) return false;
    return true;
  });
}

/// Points of the served cloud that differ from the file, but for the given ones.
std::size_t otherChanges(const Served& served, const PointCloud& cloud, const std::vector<std::uint32_t>& but = {}) {
  std::size_t changed = 0;
  for (const PointState& point : served.points())
    changed += (point.gone || point.position != cloud.positions[point.number] ||
                point.normal != cloud.normals[point.number]) &&
               std::ranges::count(but, point.number) == 0;
  return changed;
}

}  // namespace

TEST_CASE(
    "hands undo and redo their own strokes on the same points, near or whole, and skip what others have changed") {
  const PointCloud cloud = square();
  for (const auto& kinds : {std::pair{"far", "far"}, {"far", "whole"}, {"whole", "far"}}) {
    CAPTURE(kinds.first);
    CAPTURE(kinds.second);
    Served served(cloud, "undone by two");
    std::unique_ptr<UndoingHand> a = handOf(kinds.first, "undone by two"), b = handOf(kinds.second, "undone by two");
    const auto bothGet = [&](const std::vector<float>& heights) {
      CHECK(gets(*a, heights));
      CHECK(gets(*b, heights));
    };
    a->stroke(rowOf(0, 4), 1);
    bothGet({1, 1, 1, 1});
    b->stroke(rowOf(2, 3), 2);
    bothGet({1, 1, 3, 3, 2});
    CHECK(a->undo() == 2);  // the others are b's
    bothGet({0, 0, 3, 3, 2});
    CHECK(b->undo() == 3);
    bothGet({0, 0, 1, 1, 0});
    CHECK(a->redo() == 2);
    bothGet({1, 1, 1, 1, 0});
    CHECK(b->redo() == 3);
    bothGet({1, 1, 3, 3, 2});
    CHECK(b->undo() == 3);
    CHECK(a->undo() == 2);
    bothGet({0, 0, 1, 1, 0});
    CHECK(a->undo() == 0);
    CHECK(within(30, [&] { return a->isDelivered() && b->isDelivered(); }));
    served.end();
    // Points 2 and 3 were changed by b since a's stroke.
    CHECK(otherChanges(served, cloud, rowOf(2, 2)) == 0);
  }
}

TEST_CASE("a stroke is undone after the hand has moved on, but for the points that others have changed meanwhile") {
  const PointCloud cloud = square();
  for (const bool isHeard : {true, false}) {
    CAPTURE(isHeard);
    Served served(cloud, "moved on");
    FarHand hand("moved on");
    WholeHand other("moved on");
    REQUIRE(hand.comesTo(kHere));
    hand.stroke(rowOf(0, 4), 1);
    CHECK(gets(other, {1, 1, 1, 1}));
    REQUIRE(hand.comesTo(kElsewhere));
    REQUIRE(within(30, [&] {
      hand.comesTo(kElsewhere);
      return !hand.knows(rowOf(0, 1)[0]);
    }));
    if (isHeard) {
      other.stroke(rowOf(3, 1), 2);
      CHECK(within(30, [&] { return other.isDelivered(); }));
      CHECK(hand.undo() == 4);  // of which the server refuses one, as it is another's
      CHECK(gets(other, {0, 0, 0, 3}));
      CHECK(hand.redo() == 4);
      CHECK(gets(other, {1, 1, 1, 3}));
      CHECK(hand.undo() == 4);
    } else {
      served.pause();
      CHECK(hand.undo() == 4);
      served.goOn();
    }
    CHECK(gets(other, {0, 0, 0, isHeard ? 3.0f : 0.0f}));
    CHECK(within(30, [&] { return hand.isDelivered(); }));
    REQUIRE(hand.comesTo(kHere));
    CHECK(gets(hand, {0, 0, 0, isHeard ? 3.0f : 0.0f}));
    served.end();
    CHECK(otherChanges(served, cloud, rowOf(3, isHeard ? 1 : 0)) == 0);
  }
}

TEST_CASE("a server that continues from its journal has refused the same undo") {
  const PointCloud cloud = square();
  const ScratchFolder folder;
  const CloudServer::Parts parts{.name = "refused", .journal = folder / "strokes"};
  std::optional<Served> served(std::in_place, cloud, parts);
  FarHand hand("refused");
  REQUIRE(hand.comesTo(kHere));
  hand.stroke(rowOf(0, 4), 1);
  REQUIRE(within(30, [&] { return hand.isDelivered(); }));
  REQUIRE(within(30, [&] {
    hand.comesTo(kElsewhere);
    return !hand.knows(rowOf(0, 1)[0]);
  }));
  WholeHand other("refused");
  CHECK(gets(other, {1, 1, 1, 1}));
  other.stroke(rowOf(3, 1), 2);
  REQUIRE(within(30, [&] { return other.isDelivered(); }));
  CHECK(hand.undo() == 4);
  CHECK(gets(other, {0, 0, 0, 3}));
  REQUIRE(within(30, [&] { return hand.isDelivered(); }));
  served->end();
  const std::vector<PointState> before(served->points().begin(), served->points().end());
  served.reset();
  served.emplace(cloud, parts);
  served->end();
  CHECK(std::ranges::equal(served->points(), before));
  CHECK(before[rowOf(3, 1)[0]].position.z == 3);
}

TEST_CASE("undo takes effect at once while the link is down, and reaches the server and others once it is up") {
  const PointCloud cloud = square();
  const ScratchFolder folder;
  const CloudServer::Parts parts{.name = "up and down", .journal = folder / "strokes"};
  for (const bool restarts : {false, true}) {
    CAPTURE(restarts);
    std::optional<Served> served(std::in_place, cloud, parts);
    FarHand hand("up and down");
    REQUIRE(hand.comesTo(kHere));
    hand.stroke(rowOf(0, 4), 1);
    hand.stroke(rowOf(2, 4), 1);
    CHECK(within(30, [&] { return hand.isDelivered(); }));
    restarts ? served.reset() : served->pause();
    const Stopwatch since;
    CHECK(hand.undo() == 4);
    CHECK(gets(hand, {1, 1, 1, 1, 0, 0}));
    CHECK(hand.undo() == 4);
    CHECK(gets(hand, {0, 0, 0, 0, 0, 0}));
    CHECK(hand.redo() == 4);
    CHECK(gets(hand, {1, 1, 1, 1, 0, 0}));
    CHECK(since.elapsed_s() < 1);
    CHECK_FALSE(hand.isDelivered());
    if (restarts)
      served.emplace(cloud, parts);
    else
      served->goOn();
    CHECK(within(30, [&] {
      hand.comesTo(kHere);
      return hand.isDelivered() && hand.source().known().own == 0;
    }));
    CHECK(gets(hand, {1, 1, 1, 1, 0, 0}));
    WholeHand late("up and down");
    CHECK(gets(late, {1, 1, 1, 1, 0, 0}));
    CHECK(hand.undo() == 4);
    CHECK(gets(late, {0, 0, 0, 0, 0, 0}));
    CHECK_NOTHROW(hand.far().check());
    served->end();
    CHECK(otherChanges(*served, cloud) == 0);
  }
}

TEST_CASE("beyond its budget a hand near its points undoes the last strokes and counts the others") {
  const PointCloud cloud = square();
  Served served(cloud, "budget");
  constexpr std::size_t kStrokes = 6, kKept = 3;
  FarHand hand("budget", {kKept * (sizeof(HistoryChange) + 3 * sizeof(PointState))});
  REQUIRE(hand.comesTo(kHere));
  for (std::uint32_t i = 0; i < kStrokes; ++i) hand.stroke(rowOf(0, 3), 1);
  CHECK(hand.counts().undoCount == kKept);
  CHECK(hand.counts().dropped == kStrokes - kKept);
  std::size_t undone = 0;
  while (hand.undo() == 3) ++undone;
  CHECK(undone == kKept);
  CHECK(gets(hand, {3, 3, 3}));
  hand.stroke(rowOf(0, 30), 1);  // larger than the whole budget
  CHECK(hand.counts().tooLarge == 1);
  CHECK(hand.undo() == 0);
}

TEST_CASE("a session near its points undoes, redoes and saves: each point as before, and the file says what it lacks") {
  const auto cpu = cpuBackend();
  const Model served = sphereModel(20'000);
  Served server(served.cloud, "session");
  Log log(true);
  const SessionConfig config{
      .model = {.file = "session", .join = JoinConfig{.domain = ownDomain(), .partial = true}},
      .backend = {.name = "cpu"},
      .brush = BrushConfig{.kind = BrushKind::push, .radius_mm = 10, .resample = false},
  };
  Session session(config, loadModel(config.model, {.log = log, .join = sessionJoiner({})}),
                  {.backend = *cpu, .threads = 1, .keepsPoints = true, .undo = {1 << 26}});
  CHECK(session.pointHistory() == nullptr);
  runAlone(session, strokeFrom(DVec3(0, 0, 1), 3));
  session.finish();
  const SculptedCloud dented = session.sculpted();
  CHECK(dented.edited > 20);
  CHECK(dented.remark.find(fmt::format("{} of 20000 points", dented.cloud.size())) == 0);
  CHECK(std::ranges::count(dented.cloud.storedAs.comments, "comment palpate: " + dented.remark) == 1);
  REQUIRE(dented.cloud.extra.size() == 1);
  // Of the points that are known: those that differ from the file, by number.
  const auto changed = [&](const PointCloud& cloud) {
    std::map<std::uint32_t, std::pair<Vec3, Vec3>> points;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      std::uint32_t number = 0;
      std::memcpy(&number, cloud.extra[0].data.data() + i * sizeof number, sizeof number);
      if (cloud.positions[i] != served.cloud.positions[number]) points[number] = {cloud.positions[i], cloud.normals[i]};
    }
    return points;
  };
  CHECK(changed(dented.cloud).size() > 20);
  CHECK(session.strokes().undoCount == 1);
  CHECK(session.undo(1, 0).undone == 1);
  CHECK(changed(session.sculpted().cloud).empty());
  CHECK(session.undo(0, 1).redone == 1);
  CHECK(changed(session.sculpted().cloud) == changed(dented.cloud));
  CHECK(session.undo(2, 0).undone == 1);
  CHECK(session.settleShared(30));
  CHECK(session.saveAtServer() == ServerSave{.words = "it was started without --save"});
  server.end();
  const Stopwatch silent;
  CHECK(session.saveAtServer() == ServerSave{.words = "it is silent"});
  CHECK(silent.elapsed_s() < 20);
  CHECK(otherChanges(server, served.cloud) == 0);
  CHECK(server.end().states > 60);
}

}  // namespace palpate::far_undo_test
