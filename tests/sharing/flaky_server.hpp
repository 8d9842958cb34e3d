// A server over a link that damages points: it answers in place of a paused one.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <thread>
#include <variant>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/sharing/near_feed.hpp"
#include "haptics/sharing/whole_feed.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

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

}  // namespace palpate
