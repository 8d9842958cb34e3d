// What is in the samples of a stream: points as served and then edits, or the bricks around hands.
#include <doctest/doctest.h>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/sharing/near_feed.hpp"
#include "haptics/sharing/whole_feed.hpp"
#include "tests/sharing/own_network.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::feeds_test {

using namespace sharing;

namespace {

constexpr Id kClient{1}, kOther{2};

/// A served square, and a stream to one client without a reader.
struct World {
  PointCloud cloud = square();
  SharedPoints points{statesOf(cloud)};
  Participant participant{ownNetwork()};
  Topics topics{participant};
  ClientStream stream{participant, topics, Id{9}, kClient};
  StreamSample sample;

  template <class Feed>
  bool next(Feed& feed) {
    sample.clear();
    return feed.next(sample, stream);
  }
  void edit(const Id& client, std::uint64_t piece, std::uint32_t point, float height) {
    PointState state = points.points()[point];
    state.position.z = height;
    REQUIRE(points.take(client, piece, {&state, 1}) == SharedPoints::Taken::taken);
  }
};

}  // namespace

TEST_CASE("a client near its hands is told that its stroke is taken only with the last brick that it wants") {
  World world;
  NearPoints near(world.points, 16, false);
  NearFeed feed(near, kClient);
  Want want{};
  palpate_sharing_Ball all{.center = {100, 100, 0}, .radius = 150};
  give(want.balls, std::span(&all, 1));
  REQUIRE(NearFeed::isValid(want));
  feed.take(want);
  feed.lookUp();
  world.edit(kClient, 1, 17, 3);
  near.update([] { return std::unordered_set<BrickKey>(); });
  std::size_t points = 0, steps = 0;
  bool isWhole = false;
  while (!isWhole) {
    REQUIRE(world.next(feed));
    points += world.sample.points.size();
    steps += world.sample.head.last;
    isWhole = world.sample.head.whole;
    CHECK(world.sample.head.acked == (isWhole ? 1 : 0));
  }
  while (!world.sample.head.last) {
    REQUIRE(world.next(feed));
    points += world.sample.points.size();
  }
  CHECK(points == world.cloud.size());
  CHECK(steps > 20);  // a step has some thousand points
  CHECK_FALSE(world.next(feed));
}

TEST_CASE("a client of the whole cloud gets each block once, then each edited point once, and then signs of life") {
  World world;
  Want want{};
  want.every = 1;
  want.edits = true;
  REQUIRE(WholeFeed::isValid(want, world.cloud));
  world.edit(kOther, 1, 5, 1);
  WholeFeed feed({.cloud = world.cloud, .points = world.points, .client = kClient}, want);
  std::size_t points = 0;
  for (std::uint64_t block = 0; block < blocksOf(world.cloud.size()); ++block) {
    REQUIRE(world.next(feed));
    for (const Point& point : world.sample.points) REQUIRE(point.position[0] == world.cloud.positions[points++].x);
    CHECK(world.sample.states.empty());
    CHECK_FALSE(world.sample.head.whole);
  }
  CHECK(points == world.cloud.size());
  world.edit(kOther, 2, 5, 2);
  world.edit(kClient, 1, 6, 3);  // its own
  REQUIRE(world.next(feed));
  REQUIRE(world.sample.states.size() == 1);
  CHECK(world.sample.states[0].position[2] == 2);
  CHECK(world.sample.head.acked == 1);
  CHECK(world.sample.head.upTo == world.sample.head.head);
  CHECK(world.sample.head.whole);
  CHECK_FALSE(world.next(feed));
  CHECK(feed.due_s() > 0.3);
  world.edit(kOther, 3, 7, 1);
  CHECK(feed.due_s() < 0.01);  // edits of 8 ms are merged
  REQUIRE(within(5, [&] { return world.next(feed); }));
  CHECK(world.sample.states.size() == 1);
  const Stopwatch silent;
  REQUIRE(within(5, [&] { return world.next(feed); }));
  CHECK(silent.elapsed_s() > 0.3);
  CHECK(world.sample.states.empty());
  CHECK(world.sample.head.digest == world.points.digest());
}

TEST_CASE("a probe of a silent client states what the last sample stated, also where nothing was due since") {
  World world;
  Want want{};
  want.epoch = want.number = 1;
  want.every = 1;
  want.first = static_cast<std::uint32_t>(blocksOf(world.cloud.size()));
  want.edits = true;
  world.edit(kOther, 1, 5, 1);
  REQUIRE(world.stream.take(want) == ClientStream::Asked::fresh);
  WholeFeed feed({.cloud = world.cloud, .points = world.points, .client = kClient}, want);
  constexpr std::uint64_t kWindow = 4;
  REQUIRE(world.stream.send(feed, kWindow) == ClientStream::Sent::sent);
  const Points stated = world.stream.last().head;
  REQUIRE(stated.digest == world.points.digest());
  REQUIRE(world.stream.send(feed, kWindow) == ClientStream::Sent::nothing);
  REQUIRE(within(5, [&] {
    world.stream.probe();
    return world.stream.last().head.sample == stated.sample + 1;
  }));
  const Points& probe = world.stream.last().head;
  CHECK(world.stream.last().states.empty());
  CHECK(probe.digest == stated.digest);
  CHECK(probe.upTo == stated.upTo);
  CHECK(probe.head == stated.head);
  CHECK(probe.acked == stated.acked);
}

TEST_CASE("a sample of any kind fits into one Ethernet frame") {
  StreamSample sample;
  sample.points.resize(kBlockPoints);
  sample.parts.resize(1);
  const auto bytes = [&] {
    // Head, six lengths, and the elements.
    return 88 + 24 + sample.parts.size() * sizeof(BrickPart) + sample.ids.size() * 4 +
           sample.points.size() * sizeof(Point) + sample.velocities.size() * 4 + sample.states.size() * sizeof(State) +
           (sample.forces == HandsForces{} ? 0 : sizeof sample.forces);
  };
  constexpr std::size_t kFragment = 1344;  // what DDS sends whole (dds.cpp)
  CHECK(bytes() <= kFragment);
  sample.clear();
  sample.states.resize(kStates);
  CHECK(bytes() <= kFragment);
  sample.clear();
  World world;
  NearPoints near(world.points, 16, false);
  NearFeed feed(near, kClient);
  Want want{};
  palpate_sharing_Ball all{.center = {100, 100, 0}, .radius = 150};
  give(want.balls, std::span(&all, 1));
  feed.take(want);
  feed.lookUp();
  near.update([] { return std::unordered_set<BrickKey>(); });
  while (feed.next(sample, world.stream)) {
    CHECK(bytes() <= kFragment);
    sample.clear();
  }
}

}  // namespace palpate::feeds_test
