// The points around hands, without a network: hands that wander over a cloud that is sculpted meanwhile, over slow
// links. Every point that a hand may feel is present as in the whole cloud, or the tick is known to lack some.
#include <doctest/doctest.h>

#include <deque>
#include <map>
#include <random>
#include <set>

#include "haptics/sharing/brick_assembly.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/hand_balls.hpp"

namespace palpate::near_bricks_test {

using namespace sharing;

namespace {

constexpr double kSupport = 2;  // with points one apart

/// A bumpy sheet, one point in each unit square.
std::vector<PointState> sheet(int side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> jitter(-0.4f, 0.4f);
  std::vector<PointState> points;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      PointState point{.number = static_cast<std::uint32_t>(points.size()),
                       .normal = Vec3(0, 0, 1),
                       .color = static_cast<std::uint32_t>(points.size() & 0xffffff)};
      point.position = Vec3(static_cast<float>(x) + jitter(random), static_cast<float>(y) + jitter(random),
                            3 * std::sin(0.2f * static_cast<float>(x)));
      point.parent = point.number;
      points.push_back(point);
    }
  return points;
}

/// By id. Points are only moved up and down, so that each is within one of its lattice position.
std::vector<std::uint32_t> near(const std::vector<PointState>& points, int side, const DVec3& hip) {
  std::vector<std::uint32_t> found;
  const auto first = [&](double at) { return std::max(static_cast<int>(std::floor(at - kSupport)) - 1, 0); };
  const auto last = [&](double at) { return std::min(static_cast<int>(std::ceil(at + kSupport)) + 1, side - 1); };
  for (int y = first(hip.y); y <= last(hip.y); ++y)
    for (int x = first(hip.x); x <= last(hip.x); ++x) {
      const PointState& point =
          points[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x)];
      if (!point.gone && glm::distance(DVec3(point.position), hip) < kSupport) found.push_back(point.number);
    }
  return found;
}

struct Walk {
  unsigned seed = 1;
  double speed = 20;  // units per second
  double trip_s = 0.1;
  bool sculpts = false;
  std::size_t room = 1 << 17;
};
struct Walked {
  std::uint64_t ticks = 0, without = 0, wrong = 0, felt = 0;
  std::size_t mostKnown = 0;
};

/// Ticks of 1 ms; questions and answers take half a round trip.
Walked walk(const Walk& how, int ticks) {
  constexpr int kSide = 150;
  constexpr double kEdge = 8, kTick_s = 1e-3;
  std::mt19937 random(how.seed);
  std::vector<PointState> points = sheet(kSide, how.seed);
  ServedBricks served(kEdge);
  served.build(points);
  BrickLedger ledger;
  BrickSource source({.edge = kEdge, .points = 2 * how.room});
  HandBalls hand(kEdge, 10);
  struct Question {
    double at_s;
    std::vector<Ball> balls;
  };
  struct Answer {
    double at_s;
    BrickUpdate update;
  };
  std::deque<Question> asked;
  std::deque<Answer> answers;
  DVec3 hip(0.5 * kSide, 0.5 * kSide, 0), way(1, 0, 0);
  std::normal_distribution<double> turn(0, 0.1);
  CloudFrame frame;
  Walked walked;
  for (int tick = 0; tick < ticks; ++tick) {
    const double now_s = tick * kTick_s;
    const DVec3 turned{turn(random), turn(random), 0.2 * turn(random)};
    way = glm::normalize(way + turned);
    hip += how.speed * kTick_s * way;
    for (int k = 0; k < 3; ++k) {
      const double low = k == 2 ? -6 : 5, high = k == 2 ? 6 : kSide - 5;
      if (hip[k] < low || hip[k] > high) way[k] = -way[k];
      hip[k] = std::clamp(hip[k], low, high);
    }
    HandReaches reaches{.time_s = now_s, .steady_s = now_s, .count = 1};
    reaches.hands[0] = {.low = hip - kSupport, .high = hip + kSupport, .hip = hip, .proxy = hip};
    asked.push_back({now_s + 0.5 * how.trip_s, hand.around(reaches, how.trip_s)});
    // The server, every 5 ms.
    while (!asked.empty() && asked.front().at_s <= now_s) {
      const std::vector<Ball> balls = asked.front().balls;
      asked.pop_front();
      if (tick % 5 != 0) continue;
      BrickLedger::Step step =
          ledger.next(balls, bricksIn(balls, served.grid()), served, {.known = how.room, .atOnce = 500});
      CHECK(ledger.points() <= how.room);
      if (!step.isEmpty())
        answers.push_back({now_s + 0.5 * how.trip_s, {.dropped = step.dropped, .bricks = step.bricks}});
    }
    if (how.sculpts && tick < ticks / 2 && tick % 10 == 0) {
      PointState& point = points[random() % points.size()];
      point.position += Vec3(0, 0, 0.1f) * static_cast<float>(random() % 100);
      if (random() % 7 == 0) point.gone = !point.gone;
      served.follow(point.number);
    }
    while (!answers.empty() && answers.front().at_s <= now_s) {
      source.apply(std::move(answers.front().update));
      answers.pop_front();
    }
    if (source.hasNewer(now_s, frame.time_s)) source.makeFrame(now_s, frame);
    walked.mostKnown = std::max(walked.mostKnown, source.known().points);
    ++walked.ticks;
    if (!source.covers(frame.time_s, hip - kSupport, hip + kSupport)) {
      ++walked.without;
      continue;
    }
    // While a stroke is in flight the result is undefined.
    if (how.sculpts && tick < ticks / 2 + 4 * how.trip_s / kTick_s) continue;
    std::vector<Vec3> is, should;
    for (const Vec3& position : frame.positions)  // one coordinate excludes nearly all points
      if (std::abs(position.x - hip.x) < kSupport && glm::distance(DVec3(position), hip) < kSupport)
        is.push_back(position);
    for (const std::uint32_t id : near(points, kSide, hip)) should.push_back(points[id].position);
    walked.wrong += is != should;
    walked.felt += !should.empty();
  }
  return walked;
}

}  // namespace

TEST_CASE("each position has one brick, which its key identifies") {
  const BrickGrid grid(0.7);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1e6, 1e6);
  for (int i = 0; i < 10'000; ++i) {
    const double x = place(random), y = place(random);
    const DVec3 at(x, i % 2 ? y : 0.7 * (i % 9), -1e-9 * i);
    const IVec3 brick = grid.brickAt(at);
    CHECK(BrickGrid::brickOf(BrickGrid::keyOf(brick)) == brick);
    CHECK(BrickGrid::isKey(BrickGrid::keyOf(brick)));
    if (glm::length(at) < 5e5) CHECK(grid.distance(brick, at) == 0);
  }
  CHECK_FALSE(BrickGrid::isKey(~BrickKey{0}));
}

TEST_CASE("points around a wandering hand arrive before it, at any round trip, and equal the cloud's in order") {
  for (const double trip_s : {0.002, 0.1, 0.5})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      CAPTURE(trip_s);
      CAPTURE(seed);
      const Walked walked = walk({.seed = seed, .speed = 25, .trip_s = trip_s}, 4000);
      CHECK(walked.wrong == 0);
      CHECK(walked.felt > 500);
      // Until the first points arrive.
      CHECK(static_cast<double>(walked.without) < 1000 * trip_s + 40);
      CHECK(walked.without > 0);
    }
}

TEST_CASE("a hand faster than its points detects missing points and never feels wrong ones") {
  constexpr int kTicks = 1600;
  const Walked walked = walk({.seed = 5, .speed = 900, .trip_s = 0.5}, kTicks);
  CHECK(walked.wrong == 0);
  CHECK(walked.without > walk({.seed = 5, .speed = 25, .trip_s = 0.5}, kTicks).without + 20);
  CHECK(walked.without < kTicks);
}

TEST_CASE("strokes of other hands reach the bricks that a hand has") {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const Walked walked = walk({.seed = seed, .speed = 25, .trip_s = 0.1, .sculpts = true}, 4000);
    CHECK(walked.wrong == 0);
    CHECK(walked.felt > 200);
  }
}

TEST_CASE("a client keeps no more points than fit, the nearest first") {
  const Walked walked = walk({.seed = 2, .speed = 25, .trip_s = 0.1, .room = 1200}, 3000);
  CHECK(walked.mostKnown <= 1200);
  CHECK(walked.mostKnown > 600);
  CHECK(walked.wrong == 0);
  CHECK(walked.without < 300);
}

TEST_CASE("a client's moving points all belong to the same time after each step") {
  constexpr double kEdge = 4;
  ServedBricks served(kEdge);
  BrickLedger ledger;
  std::map<BrickKey, std::shared_ptr<const Brick>> known;
  std::set<BrickKey> shown;
  DVec3 at(0);
  for (int turn = 0; turn < 300; ++turn) {
    at += DVec3(0.5, 0.3 * (turn % 7), 0);
    const std::vector<Ball> balls{{.center = at, .radius = 10}};
    const std::vector<BrickKey> wanted = bricksIn(balls, served.grid());
    CloudFrame frame{.time_s = turn * 0.1};
    for (std::uint32_t i = 0; i < 2000; ++i) {
      frame.positions.push_back(Vec3(at + DVec3(std::sin(i) * 12, std::cos(3.0 * i) * 12, 0.01 * turn)));
      frame.normals.emplace_back(0, 0, 1);
      frame.velocities.emplace_back(0, 0, turn);
    }
    // Every second request is for bricks that the last frame was not searched for; the next frame contains them.
    if (turn % 2 == 0) {
      shown = {wanted.begin(), wanted.end()};
      served.show(frame, {wanted.begin(), wanted.end()});
    }
    const BrickLedger::Step step = ledger.next(balls, wanted, served, {.known = 1 << 14, .atOnce = 1 << 14});
    for (const BrickKey key : step.dropped) CHECK(known.erase(key) == 1);
    for (const auto& [key, brick] : step.bricks) {
      CHECK(shown.contains(key));  // whether other bricks are empty is unknown
      known[key] = brick.points;
    }
    for (const auto& [key, brick] : known)
      for (const Vec3& velocity : brick->velocities) CHECK(velocity.z == static_cast<float>(turn - turn % 2));
    CHECK(known.size() == ledger.size());
  }
  CHECK(known.size() > 20);
}

namespace {

/// A sample of two points in one brick, and its parts.
struct OneSample {
  OneSample() {
    sample.epoch = 1;
    sample.sample = 1;
    sample.last = sample.whole = true;
  }
  Heard hear(BrickAssembly& assembly) {
    give(sample.parts, parts);
    give(sample.ids, ids);
    give(sample.points, points);
    give(sample.velocities, velocities);
    give(sample.forces, forces);
    return assembly.hear(sample);
  }
  Points sample{};
  std::vector<BrickPart> parts{{.key = BrickGrid::keyOf(IVec3(0)), .total = 2, .count = 2}};
  std::vector<std::uint32_t> ids{3, 8};
  std::vector<Point> points{{.position = {0.5, 0.5, 0.5}, .normal = {0, 0, 1}, .color = 0x030201},
                            {.position = {0.6, 0.5, 0.5}, .normal = {0, 1, 0}, .color = 0}};
  std::vector<float> velocities, forces;
};

BrickAssembly freshAssembly(std::size_t room = 100) {
  BrickAssembly assembly(1, room);
  CHECK(assembly.begin() == 1);
  return assembly;
}

}  // namespace

TEST_CASE("a step is assembled from its samples; a missing sample is detected, and all are requested again") {
  BrickAssembly assembly = freshAssembly();
  OneSample first, second;
  first.parts[0].count = 1;
  first.ids = {3};
  first.points.resize(1);
  first.sample.last = false;
  second.sample.sample = 2;
  second.parts[0].count = 1;
  second.ids = {8};
  second.points.erase(second.points.begin());
  second.parts.push_back({.key = BrickGrid::keyOf(IVec3(1, 0, 0)), .total = 0, .count = 0});
  second.forces.assign(3 * kMaxHands, 0);
  second.forces[4] = 2;
  CHECK(second.hear(assembly) == Heard::gap);
  CHECK(first.hear(assembly) == Heard::taken);
  CHECK(first.hear(assembly) == Heard::old);
  CHECK_FALSE(assembly.takeUpdate());
  CHECK(second.hear(assembly) == Heard::taken);
  const auto update = assembly.takeUpdate();
  REQUIRE(update);
  REQUIRE(update->bricks.size() == 2);
  CHECK(update->bricks[0].second.points->ids == std::vector<std::uint32_t>{3, 8});
  CHECK(update->bricks[0].second.points->colors[0] == 0x030201);
  CHECK(update->bricks[1].second.points->size() == 0);
  CHECK(update->force_N[0] == Vec3(0));
  CHECK(update->force_N[1] == Vec3(0, 2, 0));
  // After a restart received bricks stay until they are received again; those not received with the rest are dropped.
  CHECK(assembly.begin() == 2);
  OneSample again;
  CHECK(again.hear(assembly) == Heard::old);
  again.sample.epoch = 2;
  CHECK(again.hear(assembly) == Heard::taken);
  const auto restarted = assembly.takeUpdate();
  REQUIRE(restarted);
  CHECK(restarted->bricks.size() == 1);
  CHECK(restarted->dropped == std::vector<BrickKey>{BrickGrid::keyOf(IVec3(1, 0, 0))});
}

TEST_CASE("invalid brick samples are refused") {
  const auto refuses = [](const std::function<void(OneSample&)>& spoil) {
    BrickAssembly assembly = freshAssembly();
    OneSample one;
    spoil(one);
    CHECK_THROWS_AS(one.hear(assembly), NetworkError);
  };
  BrickAssembly roomy = freshAssembly(), small = freshAssembly(1);
  OneSample good, large;
  CHECK(good.hear(roomy) == Heard::taken);
  CHECK_THROWS_AS(large.hear(small), NetworkError);
  refuses([](OneSample& one) { one.ids.pop_back(); });
  refuses([](OneSample& one) { one.ids = {8, 8}; });
  refuses([](OneSample& one) { one.parts[0].total = 1; });
  refuses([](OneSample& one) { one.parts[0].total = 3; });
  refuses([](OneSample& one) { one.parts[0].count = 1; });
  refuses([](OneSample& one) { one.parts[0].count = 3; });
  refuses([](OneSample& one) { one.parts[0].key = ~BrickKey{0}; });
  refuses([](OneSample& one) { one.parts[0].key = BrickGrid::keyOf(IVec3(5, 0, 0)); });
  refuses([](OneSample& one) { one.points[1].position[2] = std::numeric_limits<float>::quiet_NaN(); });
  refuses([](OneSample& one) { one.points[1].normal[2] = 2; });
  refuses([](OneSample& one) { one.velocities = {1, 2, 3}; });
  refuses([](OneSample& one) { one.velocities.assign(6, std::numeric_limits<float>::infinity()); });
  refuses([](OneSample& one) { one.forces = {0, 1, 0}; });
  refuses([](OneSample& one) { one.forces.assign(3 * kMaxHands, std::numeric_limits<float>::quiet_NaN()); });
  refuses([](OneSample& one) { one.sample.true_s = std::numeric_limits<double>::infinity(); });
}

TEST_CASE("random brick samples cause no failure and stay bounded") {
  std::mt19937 random(17);
  int taken = 0;
  for (int i = 0; i < 20'000; ++i) {
    BrickAssembly assembly = freshAssembly(50);
    OneSample one;
    one.parts.clear();
    one.ids.clear();
    one.points.clear();
    for (unsigned k = random() % 4; k > 0; --k)
      one.parts.push_back(
          {.key = random() % 3 ? BrickGrid::keyOf(IVec3(0)) : BrickKey{random()} << random() % 40,
           .total = random() % 5 ? static_cast<std::uint32_t>(random() % 3) : static_cast<std::uint32_t>(random()),
           .count = random() % 5 ? static_cast<std::uint32_t>(random() % 3) : static_cast<std::uint32_t>(random())});
    for (unsigned k = random() % 4; k > 0; --k) {
      one.ids.push_back(k);
      one.points.push_back({.position = {0.5f, 0.5f, random() % 9 ? 0.5f : -7.0f}, .normal = {0, 0, 1}});
    }
    try {
      taken += one.hear(assembly) == Heard::taken;
    } catch (const NetworkError&) {
    }
  }
  CHECK(taken > 100);
}

}  // namespace palpate::near_bricks_test
