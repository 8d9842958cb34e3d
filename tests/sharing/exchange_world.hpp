// A server, its clients and the links between them, in one thread and from one seed.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::exchange_world {

using namespace sharing;

inline constexpr std::size_t kAtOnce = 5;  // states of a piece, a result, an offer

inline std::vector<PointState> pointsOf(std::uint32_t count) {
  std::vector<PointState> points;
  for (std::uint32_t i = 0; i < count; ++i)
    points.push_back({.position = Vec3(static_cast<float>(i), 0, 0), .number = i, .normal = {0, 0, 1}, .parent = i});
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
      if (point.gone || dice() % 9 == 0) {
        point.gone = !point.gone;
      } else {
        point.position += Vec3(way(dice), way(dice), 0);
        point.color = static_cast<std::uint32_t>(dice());
      }
      batch_.points.push_back(point);
      ++made_;
    }
  }
  /// Moves a point as undo does: unless others have changed it meanwhile.
  void goBack(std::mt19937& dice) {
    carryOut();
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::stroke});
    PointState& point = points_[dice() % points_.size()];
    point.position.z += 1;
    point.gone = false;
    batch_.points.push_back(point);
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::change});
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
      PointState& point = points_[change.to.number];
      CHECK_FALSE((change.from.gone && change.to.gone));
      const bool stands =
          point.gone == change.from.gone &&
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

inline std::vector<PointState> copyOf(std::span<const PointState> points) { return {points.begin(), points.end()}; }

// Removed points are equal if their ids are.
inline bool same(const std::vector<PointState>& a, std::span<const PointState> b) {
  return std::ranges::equal(
      a, b, [](const PointState& p, const PointState& q) { return p.gone && q.gone ? p.number == q.number : p == q; });
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

/// The next result for a client; `place` advances.
inline Told resultFor(SharedPoints& points, SharedPoints::Place& place, const Id& client, const Resume& asked,
                      std::uint64_t sample) {
  Told told;
  points.collect(place, client, kAtOnce, told.states);
  told.results = {.epoch = asked.epoch,
                  .sample = sample,
                  .acked = points.lastOf(client),
                  .upTo = place.upTo,
                  .head = points.head(),
                  .digest = points.digest(),
                  .states = {}};
  return told;
}
inline Heard hear(EditExchange& exchange, const Told& told) {
  Results results = told.results;
  results.states = told.states;
  return exchange.hear(results);
}

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

  /// All that is in flight is lost.
  void cut() {
    strokes.cut();
    resumes.cut();
    results.cut();
  }
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
    if (dice_() % 200 == 0) clients_[dice_() % clients_.size()]->cut();
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
  std::uint64_t refused() const { return refused_; }  ///< changes of points that another hand had changed
  std::uint64_t takenPieces() const { return journal_.size(); }

 private:
  void resume(Client& client) { client.resumes.send(client.exchange.resume(), now_, dice_); }

  void stepClient(Client& client, bool brushes) {
    if (brushes && dice_() % 3 == 0) client.answering.brush(dice_);
    if (brushes && dice_() % 12 == 0) client.answering.goBack(dice_);
    if (dice_() % 4 == 0) client.answering.carryOut();
    if (dice_() % 3 == 0) client.exchange.follow(client.answering.take());
    bool gap = false;
    client.results.arrive(now_, [&](const Told& told) {
      if (gap) return;
      const auto heard = hear(client.exchange, told);
      if (heard == Heard::taken) client.lastHeard = now_;
      gap = heard == Heard::gap;
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
        if (points_.take(client->id, piece.number, piece.states, piece.replaced) != SharedPoints::Taken::taken) return;
        StrokePiece taken = piece;  // as StrokeServer has it in its journal
        for (std::size_t i = 0; i < taken.replaced.size(); ++i) {
          const PointState& present = points_.points()[taken.states[i].number];
          refused_ += !(present == taken.states[i]);
          taken.states[i] = present;
        }
        journal_.push_back({client->id, std::move(taken)});
      });
    }
    for (auto& client : clients_) {
      const auto found = followers_.find(client->id);
      if (found == followers_.end()) continue;
      Follower& follower = found->second;
      const std::uint64_t acked = points_.lastOf(client->id);
      if (!points_.isBehind(follower.place) && acked == follower.told && now_ % 10 != 0) continue;
      follower.told = acked;
      client->results.send(resultFor(points_, follower.place, client->id, follower.asked, ++follower.counter), now_,
                           dice_);
    }
  }

  // Another server, restored from the journal; followers must request again.
  void restart() {
    ++restarts_;
    points_ = SharedPoints(served_);
    for (const auto& [id, piece] : journal_)
      REQUIRE(points_.take(id, piece.number, piece.states) == SharedPoints::Taken::taken);
    followers_.clear();
    for (auto& client : clients_) client->cut();
  }

  std::mt19937 dice_;
  std::vector<PointState> served_;
  SharedPoints points_;
  std::vector<std::pair<Id, StrokePiece>> journal_;
  std::map<Id, Follower> followers_;
  std::vector<std::unique_ptr<Client>> clients_;
  int now_ = 0;
  std::uint64_t restarts_ = 0, refused_ = 0;
};

inline void settle(World& world) {
  int steps = 0;
  // All edits must be received before it can be at rest.
  for (; steps < 200 || !world.isAtRest(); ++steps) {
    REQUIRE(steps < 20'000);
    world.step(false, false);
  }
}

}  // namespace palpate::exchange_world
