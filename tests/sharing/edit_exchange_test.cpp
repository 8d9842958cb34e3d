// Many hands, a server and links that delay, break and lose, all in one thread and from one seed: in the end every
// point is everywhere as it was changed last, and no hand lost what it alone has done.
#include "haptics/sharing/edit_exchange.hpp"

#include <doctest/doctest.h>

#include "tests/sharing/exchange_world.hpp"

namespace palpate::edit_exchange_test {

using namespace exchange_world;

TEST_CASE("all clients converge to the last state of every point, whatever the links and the server do") {
  std::uint64_t restarts = 0, resent = 0, received = 0, refused = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    World world(seed, 1 + seed % 5, seed % 2 == 0);
    for (int i = 0; i < 2000; ++i) world.step(i % 500 < 350, seed % 3 != 0);
    settle(world);
    world.check();
    restarts += world.restarts();
    refused += world.refused();
    for (std::size_t i = 0; i < 1 + seed % 5; ++i) {
      resent += world.client(i).exchange.resent();
      received += world.client(i).exchange.receivedStates();
    }
  }
  // The simulated faults did occur.
  CHECK(restarts > 50);
  CHECK(resent > 100);
  CHECK(refused > 100);
  CHECK(received > 10'000);
}

TEST_CASE("the edits of a lone hand are never replaced, and each of its pieces counts once") {
  World world(7, 2, true);
  std::vector<PointState> made;
  for (int i = 0; i < 1500; ++i) {
    // The second client only follows.
    if (i < 1000 && i % 4 == 0) {
      std::mt19937 dice(static_cast<unsigned>(i));
      world.client(0).answering.brush(dice);
      made = world.client(0).answering.points();
    }
    world.step(false, true);
    if (!made.empty()) CHECK(world.client(0).answering.points() == made);
  }
  settle(world);
  world.check();
  CHECK(world.client(0).exchange.receivedStates() == 0);
  CHECK(std::ranges::equal(world.points().points(), made));
  CHECK(world.takenPieces() == world.points().lastOf(world.client(0).id));
}

namespace {

void carryOutOneOffer(EditExchange& exchange) {
  const auto offer = exchange.nextOffer();
  REQUIRE(offer.size() == 1);
  exchange.offered();
  exchange.follow({.points = {offer[0].to}, .marks = {{1, EditMark::Kind::received}}});
  CHECK(exchange.isAtRest());
  CHECK(exchange.isSame());
}

}  // namespace

TEST_CASE("a zero of opposite sign is a different state, as in the digest") {
  const auto points = pointsOf(3);
  EditExchange exchange(points, kAtOnce);
  const Resume asked = exchange.resume();
  PointState other = points[1];
  other.normal.x = -0.0F;
  SharedPoints server(points);
  REQUIRE(server.take(Id{1}, 1, {&other, 1}) == SharedPoints::Taken::taken);
  CHECK(exchange.hear({.epoch = asked.epoch,
                       .sample = 1,
                       .upTo = 1,
                       .head = 1,
                       .digest = server.digest(),
                       .states = {&other, 1}}) == Heard::taken);
  carryOutOneOffer(exchange);
}

TEST_CASE("a client that asks for the state is at rest only after the answer, not by earlier results") {
  const auto points = pointsOf(3);
  const Id client{1}, other{2};
  SharedPoints server(points);
  EditExchange exchange(points, kAtOnce);
  SharedPoints::Place place;
  const Resume first = exchange.resume();
  REQUIRE(hear(exchange, resultFor(server, place, client, first, 1)) == Heard::taken);
  REQUIRE(exchange.isAtRest());
  // The server takes a stroke of another hand and reports it to that hand; its result for this one is still in flight.
  PointState moved = points[1];
  moved.position.z = 1;
  REQUIRE(server.take(other, 1, {&moved, 1}) == SharedPoints::Taken::taken);
  const Told underWay = resultFor(server, place, client, first, 2);
  CHECK(exchange.isAtRest());  // according to the last result
  const Resume asked = exchange.ask();
  CHECK_FALSE(exchange.isInEffect());
  CHECK_FALSE(exchange.isAtRest());
  CHECK(hear(exchange, underWay) == Heard::old);
  place = {.upTo = asked.upTo, .ownUpTo = 0};
  CHECK(hear(exchange, resultFor(server, place, client, asked, 1)) == Heard::taken);
  CHECK_FALSE(exchange.isAtRest());  // until that stroke is in effect here
  carryOutOneOffer(exchange);
}

TEST_CASE("undo of a point that another hand has changed meanwhile is refused, and both ends have the other's state") {
  const auto points = pointsOf(3);
  const Id client{1}, other{2};
  SharedPoints server(points);
  EditExchange exchange(points, kAtOnce);
  SharedPoints::Place place;
  const Resume asked = exchange.resume();
  std::uint64_t samples = 0;
  const auto send = [&] {
    const StrokePiece* const piece = exchange.outbox().nextPiece(kAtOnce);
    REQUIRE(piece);
    REQUIRE(server.take(client, piece->number, piece->states, piece->replaced) == SharedPoints::Taken::taken);
  };
  PointState moved = points[1], theirs = points[1], alone = points[2];
  moved.position.z = 1;
  theirs.position.z = 2;
  alone.position.z = 3;
  exchange.follow({.points = {moved, alone}, .marks = {{2, EditMark::Kind::stroke}}});
  send();
  REQUIRE(hear(exchange, resultFor(server, place, client, asked, ++samples)) == Heard::taken);
  REQUIRE(server.take(other, 1, {&theirs, 1}) == SharedPoints::Taken::taken);
  const Told underWay = resultFor(server, place, client, asked, ++samples);
  exchange.follow({.points = {points[1], points[2]}, .marks = {{2, EditMark::Kind::change}}});
  send();
  CHECK(server.points()[1] == theirs);
  CHECK(server.points()[2] == points[2]);
  REQUIRE(hear(exchange, underWay) == Heard::taken);
  CHECK(exchange.points()[1] == points[1]);  // until the server has answered
  REQUIRE(hear(exchange, resultFor(server, place, client, asked, ++samples)) == Heard::taken);
  carryOutOneOffer(exchange);
  CHECK(exchange.points()[1] == theirs);
}

TEST_CASE("what was not sent yet is merged: only a lone undo, or undo and redo, depends on the state before") {
  const auto points = pointsOf(1);
  const auto sent = [&](std::initializer_list<MadeState> edits) {
    StrokeOutbox outbox;
    for (const MadeState& edit : edits) outbox.add(edit);
    const StrokePiece* const piece = outbox.nextPiece(36);
    REQUIRE(piece);
    REQUIRE(piece->states.size() == 1);
    CHECK(piece->states[0] == (edits.end() - 1)->state);
    return piece->replaced;
  };
  PointState moved = points[0];
  moved.position.z = 1;
  const MadeState stroke{moved}, undo{points[0], 5}, redo{moved, 6};
  CHECK(sent({stroke}).empty());
  CHECK(sent({undo}) == std::vector<std::uint64_t>{5});
  CHECK(sent({undo, redo}) == std::vector<std::uint64_t>{5});
  CHECK(sent({stroke, undo}).empty());
  CHECK(sent({undo, stroke}).empty());
  // Both kinds are in pieces of their own, of which those with states that they replace have room for fewer.
  StrokeOutbox outbox;
  for (const PointState& point : pointsOf(80)) outbox.add(point.number < 40 ? MadeState{point} : MadeState{point, 1});
  std::vector<std::size_t> sizes;
  while (const StrokePiece* const piece = outbox.nextPiece(36)) {
    sizes.push_back(piece->states.size());
    CHECK(piece->replaced.size() == (sizes.size() > 2 ? piece->states.size() : 0));
  }
  CHECK(sizes == std::vector<std::size_t>{36, 4, 32, 8});
}

TEST_CASE("asking for the state resends nothing, resuming does") {
  const auto points = pointsOf(3);
  EditExchange exchange(points, kAtOnce);
  exchange.resume();
  PointState moved = points[1];
  moved.position.z = 1;
  exchange.follow({.points = {moved}, .marks = {{1, EditMark::Kind::stroke}}});
  REQUIRE(exchange.outbox().nextPiece(kAtOnce));
  const Resume asked = exchange.ask();
  CHECK(asked.epoch == 2);
  CHECK_FALSE(exchange.outbox().nextPiece(kAtOnce));
  CHECK(exchange.resent() == 0);
  CHECK(exchange.resume().epoch == 3);
  CHECK(exchange.outbox().nextPiece(kAtOnce));
  CHECK(exchange.resent() == 1);
}

TEST_CASE("only the last state of a point is forwarded if it changes faster than the link carries") {
  SharedPoints points(pointsOf(10));
  const Id maker{1}, follower{2};
  for (std::uint64_t piece = 1; piece <= 1000; ++piece) {
    const PointState state{
        .position = Vec3(0, static_cast<float>(piece), 0), .number = 3, .normal = {0, 0, 1}, .parent = 3};
    REQUIRE(points.take(maker, piece, {&state, 1}) == SharedPoints::Taken::taken);
  }
  SharedPoints::Place place;
  std::vector<PointState> states;
  points.collect(place, follower, 100, states);
  REQUIRE(states.size() == 1);
  CHECK(states[0].position.y == 1000);
  CHECK_FALSE(points.isBehind(place));
  // Its maker does not receive it, unless it restarts.
  place = {};
  states.clear();
  points.collect(place, maker, 100, states);
  CHECK(states.empty());
  place = {.ownUpTo = points.head()};
  points.collect(place, maker, 100, states);
  CHECK(states.size() == 1);
}

TEST_CASE("a client that joins after more edits than the history keeps receives every changed point once") {
  const std::uint32_t count = 300'000;
  SharedPoints points(pointsOf(count));
  const Id maker{1}, follower{2};
  std::vector<PointState> piece;
  std::uint64_t number = 0;
  // Two and a half million states: more than the history keeps in order.
  for (std::uint32_t k = 0; k < 2'500'000; ++k) {
    const std::uint32_t point = (k * 7919U) % (count / 2);
    piece.push_back(
        {.position = Vec3(static_cast<float>(k), 1, 0), .number = point, .normal = {0, 0, 1}, .parent = point});
    if (piece.size() < 1000) continue;
    REQUIRE(points.take(maker, ++number, piece) == SharedPoints::Taken::taken);
    piece.clear();
  }
  SharedPoints::Place place;
  std::vector<PointState> states = pointsOf(count), some;
  std::vector<int> times(count, 0);
  for (int turn = 0; points.isBehind(place); ++turn) {
    REQUIRE(turn < 20'000);
    some.clear();
    points.collect(place, follower, 36, some);
    CHECK(some.size() <= 36);
    for (const PointState& state : some) {
      states[state.number] = state;
      ++times[state.number];
    }
  }
  CHECK(std::ranges::equal(states, points.points()));
  CHECK(std::ranges::all_of(times, [](int n) { return n <= 1; }));
  CHECK(PointDigest(states).value() == points.digest());
}

TEST_CASE("invalid pieces and pieces out of order change nothing") {
  SharedPoints points(pointsOf(10));
  const std::uint64_t before = points.digest();
  const auto take = [&](PointState state, std::uint64_t number = 1) { return points.take(Id{1}, number, {&state, 1}); };
  const PointState good{.position = {1, 2, 3}, .number = 4, .normal = {0, 0, 1}, .parent = 4};
  std::array<PointState, 3> bad{good, good, good};
  bad[0].number = 10;
  bad[1].position.y = std::numeric_limits<float>::quiet_NaN();
  bad[2].normal.x = 1e30F;
  for (const PointState& each : bad) CHECK(take(each) == SharedPoints::Taken::refused);
  CHECK(points.take(Id{1}, 1, {}) == SharedPoints::Taken::refused);
  CHECK(take(good, 2) == SharedPoints::Taken::early);
  CHECK(points.digest() == before);
  CHECK(points.head() == 0);
  CHECK(take(good) == SharedPoints::Taken::taken);
  CHECK(take(good) == SharedPoints::Taken::known);
  CHECK(points.head() == 1);
  // At most 4096 clients may sculpt.
  for (std::uint32_t i = 2; i <= 5000; ++i)
    points.take(Id{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)}, 1, {&good, 1});
  CHECK(points.clients() == 4096);
}

}  // namespace palpate::edit_exchange_test
