// ctest: waits
// A link that damages points: each block has the server's checksum, and is requested again until it fits.
#include <doctest/doctest.h>

#include <atomic>
#include <functional>
#include <map>
#include <random>
#include <thread>
#include <variant>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/sharing/near_feed.hpp"
#include "haptics/sharing/whole_feed.hpp"
#include "tests/error_of.hpp"
#include "tests/sharing/own_network.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::damaged_points_test {

using namespace sharing;

namespace {

// A server over a link that damages points: it answers in place of a paused one.
class FlakyServer {
 public:
  /// Changes a sample after its checksums were made; returns whether it has.
  using Damage = std::function<bool(sharing::StreamSample& sample)>;
  /// `edge`: of a brick, as the paused server announces it.
  FlakyServer(const PointCloud& cloud, double edge, Damage damage)
      : cloud_(cloud),
        damage_(std::move(damage)),
        points_(statesOf(cloud)),
        near_(points_, edge, false),
        wants_(participant_, topics_.wants, sharing::bestEffortQos()),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}
  int damages() const { return damages_; }

 private:
  template <class Feed>
  struct Damaged {
    Feed& feed;
    FlakyServer& server;
    bool next(sharing::StreamSample& sample, const sharing::ClientStream& to) {
      if (!feed.next(sample, to)) return false;
      server.damages_ += server.damage_(sample);
      return true;
    }
  };
  struct Client {
    sharing::ClientStream stream;
    std::variant<std::monostate, sharing::WholeFeed, sharing::NearFeed> feed = {};
  };

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      wants_.take([&](const sharing::Want& want) { take(want); });
      near_.update([] { return std::unordered_set<BrickKey>(); });
      for (auto& [id, client] : clients_)
        std::visit(
            [&](auto& feed) {
              using Feed = std::decay_t<decltype(feed)>;
              if constexpr (!std::is_same_v<Feed, std::monostate>) {
                Damaged<Feed> damaged{feed, *this};
                while (client.stream.send(damaged, Feed::kWindow) == sharing::ClientStream::Sent::sent) {
                }
              }
            },
            client.feed);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void take(const sharing::Want& want) {
    const sharing::Id id = sharing::idOf(want.client);
    auto& client = clients_.try_emplace(id, Client{.stream = {participant_, topics_, sharing::idOf(want.session), id}})
                       .first->second;
    if (client.stream.take(want) == sharing::ClientStream::Asked::fresh) {
      if (want.every == 0)
        client.feed.emplace<sharing::NearFeed>(near_, id);
      else
        client.feed.emplace<sharing::WholeFeed>(
            sharing::WholeFeed::Parts{.cloud = cloud_, .points = points_, .client = id}, want);
    }
    if (auto* const feed = std::get_if<sharing::NearFeed>(&client.feed)) {
      feed->take(want);
      if (feed->waitsSince()) feed->lookUp();
    }
  }

  const PointCloud& cloud_;
  Damage damage_;
  sharing::SharedPoints points_;
  sharing::NearPoints near_;
  sharing::Participant participant_{ownNetwork()};
  sharing::Topics topics_{participant_};
  sharing::Reader<sharing::Want> wants_;
  std::map<sharing::Id, Client> clients_;
  std::atomic<int> damages_ = 0;
  std::jthread thread_;  // destroyed first
};

/// Flips a bit that leaves the points valid.
void flip(StreamSample& sample) { sample.points[sample.points.size() / 2].color ^= 1U << 7; }

/// A paused server of the square, in whose place another one answers.
struct Paused {
  Paused(const std::string& name, FlakyServer::Damage damage)
      : served(cloud, name), edge(announcedEdge()), flaky((served.pause(), cloud), edge, std::move(damage)) {}
  static double announcedEdge() {
    const Participant participant(ownNetwork());
    return announcedFacts(participant, Topics(participant)).edge;
  }
  PointCloud cloud = square();
  Served served;
  double edge;  // of a brick
  FlakyServer flaky;
};

}  // namespace

TEST_CASE("blocks that are damaged once or twice are requested again, with all points or those around a hand") {
  std::map<BrickKey, int> times;
  std::mt19937 dice(5);
  Paused paused("flaky", [&](StreamSample& sample) {
    if (sample.points.empty() || dice() % 8 != 0) return false;
    if (++times[sample.parts.front().key] > kMaxDamaged - 1) return false;
    flip(sample);
    return true;
  });
  const JoinedCloud whole = joinCloud("flaky", {.network = ownNetwork()});
  CHECK(whole.cloud.positions == paused.cloud.positions);
  CHECK(paused.flaky.damages() > 10);
  const JoinedCloud joined = joinNear("flaky");
  const int before = paused.flaky.damages();
  BrickSource& source = joined.far->source();
  for (const double x : {30.0, 100.0, 170.0}) {
    REQUIRE(comesTo(DVec3(x, 100, 0), source));
    std::vector<PointState> points;
    source.pointsIn(DVec3(x - 3, 97, -1), DVec3(x + 3, 103, 1), points);
    CHECK(points.size() == 49);
    for (const PointState& point : points) CHECK(point.color == 0);
  }
  CHECK(paused.flaky.damages() > before);
  CHECK(joined.far->counts().resumed > 0);
  CHECK(joined.far->takeSaid().empty());
  CHECK_NOTHROW(joined.far->check());
}

TEST_CASE("a block of the whole cloud that is damaged each time ends joining, and is named") {
  Paused paused("flaky", [](StreamSample& sample) {
    if (sample.points.empty() || sample.parts.front().key != 7) return false;
    flip(sample);
    return true;
  });
  CHECK(errorOf([] {
          joinCloud("flaky", {.network = ownNetwork()});
        }).find("block 7 of its points was received 3 times, and was damaged each time") != std::string::npos);
  CHECK(paused.flaky.damages() == kMaxDamaged);
}

TEST_CASE("a block around a hand that is damaged each time is named, and is missing") {
  std::atomic<BrickKey> key = ~BrickKey{0};
  Paused paused("flaky", [&](StreamSample& sample) {
    if (sample.points.empty() || sample.parts.front().key != key) return false;
    flip(sample);
    return true;
  });
  const JoinedCloud joined = joinNear("flaky");
  BrickSource& source = joined.far->source();
  key = source.grid().keyAt(DVec3(100, 100, 0));
  const HandReaches there = handAt(DVec3(100, 100, 0));
  source.ask(there);
  const IVec3 at = BrickGrid::brickOf(key);
  const std::string damaged =
      fmt::format("the points of the block ({}, {}, {}) are damaged, and count as missing", at.x, at.y, at.z);
  CHECK(within(30, [&] { return std::ranges::count(joined.far->takeSaid(), damaged) == 1; }));
  CHECK_FALSE(source.await(there, 0.3));
  std::vector<PointState> points;
  source.pointsIn(DVec3(99), DVec3(101), points);
  CHECK(points.empty());
  CHECK(joined.far->counts().resumed == kMaxDamaged - 1);
  CHECK(comesTo(DVec3(60, 60, 0), source));  // all around it is felt
  CHECK_NOTHROW(joined.far->check());
}

}  // namespace palpate::damaged_points_test
