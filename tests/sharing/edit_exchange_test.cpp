// Many hands, a server and links that delay, break and lose, all in one thread and from one seed: in the end every
// point is everywhere as it was changed last, and no hand lost what it alone has done.
#include "haptics/sharing/edit_exchange.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "haptics/sharing/shared_points.hpp"

namespace palpate::edit_exchange_test {

using namespace sharing;

namespace {

constexpr std::size_t kAtOnce = 5;  // states of a piece, a result, an offer

std::vector<PointState> pointsOf(std::uint32_t count) {
  std::vector<PointState> points;
  for (std::uint32_t i = 0; i < count; ++i)
    points.push_back({.position = Vec3(static_cast<float>(i), 0, 0), .id = i, .normal = {0, 0, 1}, .parent = i});
  return points;
}

/// A back end's answers: its brush moves points, offers are applied some time later.
class Answering {
 public:
  /// `cells`: a point that the brush moved out of its cell is not moved by an offer; otherwise only a point in exactly
  /// the stated position is moved.
  Answering(std::vector<PointState> points, bool cells) : points_(std::move(points)), cells_(cells) {}

  void brush(std::mt19937& dice) {
    std::uniform_real_distribution<float> way(-1.5F, 1.5F);
    for (int k = 0; k < 3; ++k) {
      PointState& point = points_[dice() % points_.size()];
      if (point.gone() || dice() % 9 == 0) {
        point.id ^= PointState::kGone;
      } else {
        point.position += Vec3(way(dice), way(dice), 0);
        point.color = static_cast<std::uint32_t>(dice());
      }
      batch_.points.push_back(point);
      ++made_;
    }
  }
  bool offer(std::span<const PointChange> changes) {
    if (!offered_.empty()) return false;
    offered_.assign(changes.begin(), changes.end());
    return true;
  }
  void carryOut() {
    if (offered_.empty()) return;
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::part});
    for (const PointChange& change : offered_) {
      PointState& point = points_[change.to.number()];
      CHECK_FALSE((change.from.gone() && change.to.gone()));
      const bool stands =
          point.gone() == change.from.gone() &&
          (cells_ ? glm::floor(point.position) == glm::floor(change.from.position) : point == change.from);
      if (!stands) continue;
      point = change.to;
      batch_.points.push_back(point);
    }
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::received});
    offered_.clear();
  }
  EditBatch take() { return std::exchange(batch_, {}); }
  const std::vector<PointState>& points() const { return points_; }
  std::uint64_t made() const { return made_; }

 private:
  std::vector<PointState> points_;
  bool cells_;
  EditBatch batch_;
  std::vector<PointChange> offered_;
  std::uint64_t made_ = 0;
};

std::vector<PointState> copyOf(std::span<const PointState> points) { return {points.begin(), points.end()}; }

// Removed points are equal if their ids are.
bool same(const std::vector<PointState>& a, std::span<const PointState> b) {
  return std::ranges::equal(
      a, b, [](const PointState& p, const PointState& q) { return p.gone() && q.gone() ? p.id == q.id : p == q; });
}

/// One direction of a link: ordered, each message some steps later; a cut loses all messages in flight.
template <class T>
class Way {
 public:
  void send(T message, int now, std::mt19937& dice) {
    ready_ = std::max(ready_, now + 1 + static_cast<int>(dice() % 12));
    messages_.emplace_back(ready_, std::move(message));
  }
  template <class Take>
  void arrive(int now, Take&& take) {
    while (!messages_.empty() && messages_.front().first <= now) {
      const T message = std::move(messages_.front().second);
      messages_.pop_front();
      take(message);
    }
  }
  void cut() { messages_.clear(); }

 private:
  std::deque<std::pair<int, T>> messages_;
  int ready_ = 0;
};

struct Told {
  Results results;
  std::vector<PointState> states;
};

struct Client {
  Client(const std::vector<PointState>& points, bool cells, std::uint8_t number)
      : answering(points, cells), exchange(points, kAtOnce), id{number} {}
  Answering answering;
  EditExchange exchange;
  Id id;
  Way<StrokePiece> strokes;
  Way<Resume> resumes;
  Way<Told> results;
  int lastHeard = 0;
};

struct Follower {
  Resume asked;
  std::uint64_t counter = 0, told = ~std::uint64_t{0};
  SharedPoints::Place place;
};

class World {
 public:
  World(unsigned seed, std::size_t clients, bool cells) : dice_(seed), served_(pointsOf(40)), points_(served_) {
    for (std::size_t i = 0; i < clients; ++i) {
      clients_.push_back(std::make_unique<Client>(served_, cells, static_cast<std::uint8_t>(i + 1)));
      resume(*clients_.back());
    }
  }

  void step(bool brushes, bool breaks) {
    ++now_;
    for (auto& client : clients_) stepClient(*client, brushes);
    stepServer();
    if (!breaks) return;
    if (dice_() % 200 == 0) {
      Client& unlucky = *clients_[dice_() % clients_.size()];
      unlucky.strokes.cut();
      unlucky.resumes.cut();
      unlucky.results.cut();
    }
    if (dice_() % 400 == 0) restart();
  }

  bool isAtRest() const {
    for (const auto& client : clients_)
      if (!client->exchange.isAtRest()) return false;
    return true;
  }
  void check() const {
    for (const auto& client : clients_) {
      CHECK(client->exchange.isSame());
      CHECK(same(client->answering.points(), points_.points()));
      CHECK(client->answering.points() == copyOf(client->exchange.points()));
      CHECK(client->exchange.digest() == PointDigest(points_.points()).value());
    }
  }
  Client& client(std::size_t i) { return *clients_[i]; }
  const SharedPoints& points() const { return points_; }
  std::uint64_t restarts() const { return restarts_; }
  std::uint64_t takenPieces() const { return journal_.size(); }

 private:
  void resume(Client& client) { client.resumes.send(client.exchange.resume(), now_, dice_); }

  void stepClient(Client& client, bool brushes) {
    if (brushes && dice_() % 3 == 0) client.answering.brush(dice_);
    if (dice_() % 4 == 0) client.answering.carryOut();
    if (dice_() % 3 == 0) client.exchange.follow(client.answering.take());
    bool gap = false;
    client.results.arrive(now_, [&](const Told& told) {
      if (gap) return;
      Results results = told.results;
      results.states = told.states;
      const auto heard = client.exchange.hear(results);
      if (heard == EditExchange::Heard::taken) client.lastHeard = now_;
      gap = heard == EditExchange::Heard::gap;
    });
    if (gap || now_ - client.lastHeard > 60) {
      resume(client);
      client.lastHeard = now_;
    }
    while (const StrokePiece* piece = client.exchange.outbox().nextPiece(kAtOnce))
      client.strokes.send(*piece, now_, dice_);
    const auto offer = client.exchange.nextOffer();
    if (!offer.empty() && client.answering.offer(offer)) client.exchange.offered();
  }

  void stepServer() {
    for (auto& client : clients_) {
      client->resumes.arrive(now_, [&](const Resume& asked) {
        Follower& follower = followers_[client->id];
        if (asked.epoch <= follower.asked.epoch) return;
        follower = {
            .asked = asked,
            .place = {.upTo = std::min(asked.upTo, points_.head()), .ownUpTo = asked.upTo == 0 ? points_.head() : 0}};
      });
      client->strokes.arrive(now_, [&](const StrokePiece& piece) {
        if (points_.take(client->id, piece.number, piece.states) == SharedPoints::Taken::taken)
          journal_.push_back({client->id, piece});
      });
    }
    for (auto& client : clients_) {
      const auto found = followers_.find(client->id);
      if (found == followers_.end()) continue;
      Follower& follower = found->second;
      const std::uint64_t acked = points_.lastOf(client->id);
      if (!points_.isBehind(follower.place) && acked == follower.told && now_ % 10 != 0) continue;
      Told told;
      points_.collect(follower.place, client->id, kAtOnce, told.states);
      told.results = {.epoch = follower.asked.epoch,
                      .counter = ++follower.counter,
                      .acked = acked,
                      .upTo = follower.place.upTo,
                      .head = points_.head(),
                      .digest = points_.digest(),
                      .states = {}};
      follower.told = acked;
      client->results.send(std::move(told), now_, dice_);
    }
  }

  // Another server, restored from the journal; followers must request again.
  void restart() {
    ++restarts_;
    points_ = SharedPoints(served_);
    for (const auto& [id, piece] : journal_)
      REQUIRE(points_.take(id, piece.number, piece.states) == SharedPoints::Taken::taken);
    followers_.clear();
    for (auto& client : clients_) {
      client->strokes.cut();
      client->resumes.cut();
      client->results.cut();
    }
  }

  std::mt19937 dice_;
  std::vector<PointState> served_;
  SharedPoints points_;
  std::vector<std::pair<Id, StrokePiece>> journal_;
  std::map<Id, Follower> followers_;
  std::vector<std::unique_ptr<Client>> clients_;
  int now_ = 0;
  std::uint64_t restarts_ = 0;
};

void settle(World& world) {
  int steps = 0;
  // All edits must be received before it can be at rest.
  for (; steps < 200 || !world.isAtRest(); ++steps) {
    REQUIRE(steps < 20'000);
    world.step(false, false);
  }
}

}  // namespace

TEST_CASE("all clients converge to the last state of every point, whatever the links and the server do") {
  std::uint64_t restarts = 0, resent = 0, received = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    World world(seed, 1 + seed % 5, seed % 2 == 0);
    for (int i = 0; i < 2000; ++i) world.step(i % 500 < 350, seed % 3 != 0);
    settle(world);
    world.check();
    restarts += world.restarts();
    for (std::size_t i = 0; i < 1 + seed % 5; ++i) {
      resent += world.client(i).exchange.resent();
      received += world.client(i).exchange.receivedStates();
    }
  }
  // The simulated faults did occur.
  CHECK(restarts > 50);
  CHECK(resent > 100);
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

TEST_CASE("a zero of opposite sign is a different state, as in the digest") {
  const auto points = pointsOf(3);
  EditExchange exchange(points, kAtOnce);
  const Resume asked = exchange.resume();
  PointState other = points[1];
  other.normal.x = -0.0F;
  SharedPoints server(points);
  REQUIRE(server.take(Id{1}, 1, {&other, 1}) == SharedPoints::Taken::taken);
  CHECK(exchange.hear({.epoch = asked.epoch,
                       .counter = 1,
                       .upTo = 1,
                       .head = 1,
                       .digest = server.digest(),
                       .states = {&other, 1}}) == EditExchange::Heard::taken);
  const auto offer = exchange.nextOffer();
  REQUIRE(offer.size() == 1);
  exchange.offered();
  exchange.follow({.points = {offer[0].to}, .marks = {{1, EditMark::Kind::received}}});
  CHECK(exchange.isAtRest());
  CHECK(exchange.isSame());
}

TEST_CASE("a client that asks for the state is at rest only after the answer, not by earlier results") {
  const auto points = pointsOf(3);
  const Id client{1}, other{2};
  SharedPoints server(points);
  EditExchange exchange(points, kAtOnce);
  const auto answer = [&](const Resume& asked, SharedPoints::Place& place, std::uint64_t counter,
                          std::vector<PointState>& states) {
    states.clear();
    server.collect(place, client, kAtOnce, states);
    return Results{.epoch = asked.epoch,
                   .counter = counter,
                   .acked = server.lastOf(client),
                   .upTo = place.upTo,
                   .head = server.head(),
                   .digest = server.digest(),
                   .states = states};
  };
  std::vector<PointState> states;
  SharedPoints::Place place;
  const Resume first = exchange.resume();
  REQUIRE(exchange.hear(answer(first, place, 1, states)) == EditExchange::Heard::taken);
  REQUIRE(exchange.isAtRest());
  // The server takes a stroke of another hand and reports it to that hand; its result for this one is still in flight.
  PointState moved = points[1];
  moved.position.z = 1;
  REQUIRE(server.take(other, 1, {&moved, 1}) == SharedPoints::Taken::taken);
  std::vector<PointState> late;
  const Results underWay = answer(first, place, 2, late);
  CHECK(exchange.isAtRest());  // according to the last result
  const Resume asked = exchange.ask();
  CHECK_FALSE(exchange.isInEffect());
  CHECK_FALSE(exchange.isAtRest());
  CHECK(exchange.hear(underWay) == EditExchange::Heard::old);
  place = {.upTo = asked.upTo, .ownUpTo = 0};
  CHECK(exchange.hear(answer(asked, place, 1, states)) == EditExchange::Heard::taken);
  CHECK_FALSE(exchange.isAtRest());  // until that stroke is in effect here
  const auto offer = exchange.nextOffer();
  REQUIRE(offer.size() == 1);
  exchange.offered();
  exchange.follow({.points = {offer[0].to}, .marks = {{1, EditMark::Kind::received}}});
  CHECK(exchange.isAtRest());
  CHECK(exchange.isSame());
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
        .position = Vec3(0, static_cast<float>(piece), 0), .id = 3, .normal = {0, 0, 1}, .parent = 3};
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
    piece.push_back({.position = Vec3(static_cast<float>(k), 1, 0), .id = point, .normal = {0, 0, 1}, .parent = point});
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
      states[state.number()] = state;
      ++times[state.number()];
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
  const PointState good{.position = {1, 2, 3}, .id = 4, .normal = {0, 0, 1}, .parent = 4};
  PointState bad = good;
  bad.id = 10;
  CHECK(take(bad) == SharedPoints::Taken::refused);
  bad = good;
  bad.position.y = std::numeric_limits<float>::quiet_NaN();
  CHECK(take(bad) == SharedPoints::Taken::refused);
  bad = good;
  bad.normal.x = 1e30F;
  CHECK(take(bad) == SharedPoints::Taken::refused);
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
