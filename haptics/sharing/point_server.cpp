#include "haptics/sharing/point_server.hpp"

#include <algorithm>
#include <unordered_set>

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxClients = 64;   // at a time; one more replaces the client that was silent for longest,
constexpr double kActive_s = 5;           // if it was silent for this long: an active client sends 20 requests a second
constexpr double kClientTimeout_s = 30;   // a client that is silent for this long is removed
constexpr std::int32_t kMaxWants = 4096;  // requests queued
constexpr std::uint64_t kMaxUnacked = 65'536;  // samples kept for clients that may not have them yet, 1.4 KB each
constexpr std::uint64_t kMinWindow = 512;      // and those of each client in any case
constexpr double kLookUp_s = 0.005;            // per round, for looking up requested bricks: other work waits meanwhile
constexpr double kSoon_s = 0.002;              // until a link without room is tried again
constexpr double kIdle_s = 0.05;
constexpr int kInTurn = 64;  // samples for one client before the next one has its turn

bool isNear(const Want& want) { return want.every == 0; }

}  // namespace

PointServer::PointServer(const Parts& parts)
    : parts_(parts),
      facts_(parts.participant, parts.topics.facts, reliableQos(true)),
      wants_(parts.participant, parts.topics.wants, keepingLast(bestEffortQos(), kMaxWants)),
      near_(parts.points, parts.facts.edge, parts.facts.moves) {
  const FarFacts& known = parts.facts;
  set(said_.session, parts.session);
  said_.moves = known.moves;
  said_.points = known.extent.points;
  for (int axis = 0; axis < 3; ++axis) {
    said_.low[axis] = known.extent.bounds.min[axis];
    said_.high[axis] = known.extent.bounds.max[axis];
  }
  said_.spacing = known.spacing;
  said_.wide_spacing = known.wideSpacing;
  said_.noise = known.noise;
  said_.up = static_cast<std::uint8_t>(known.up);
  said_.edge = known.edge;
  put(said_.matter, known.matter);
  said_.standing = known.standing;
  put(said_, parts.file);
  facts_.write(said_);
}

void PointServer::tell(const Restarts& restarts) {
  if (restarts.count == said_.restarts) return;
  said_.restarts = restarts.count;
  put(said_.why, restarts.why);
  facts_.write(said_);
}

void PointServer::take() {
  wants_.take([&](const Want& want) {
    if (isSame(want.session, parts_.session)) take(want);
  });
  std::erase_if(clients_, [](const auto& entry) {
    const auto& [stream, feed] = entry.second;
    const auto* const whole = std::get_if<WholeFeed>(&feed);
    return stream.silent_s() > kClientTimeout_s || (whole && whole->isOver() && stream.isAcknowledged());
  });
}

void PointServer::take(const Want& want) {
  Client* const client = isValid(want) ? clientOf(want) : nullptr;
  if (!client) {
    ++counts_.refused;
    return;
  }
  ++counts_.requests;
  const ClientStream::Asked asked = client->stream.take(want);
  if (asked == ClientStream::Asked::old) return;
  if (asked == ClientStream::Asked::fresh) begin(*client, want);
  if (auto* const near = std::get_if<NearFeed>(&client->feed); near && isNear(want)) near->take(want);
}

bool PointServer::isValid(const Want& want) const {
  return want.epoch > 0 && (isNear(want) ? NearFeed::isValid(want) : WholeFeed::isValid(want, parts_.cloud));
}

// Null if there are too many clients and all are active.
PointServer::Client* PointServer::clientOf(const Want& want) {
  const Id id = idOf(want.client);
  if (const auto there = clients_.find(id); there != clients_.end()) return &there->second;
  if (clients_.size() >= kMaxClients) {
    const auto last =
        std::ranges::max_element(clients_, {}, [](const auto& entry) { return entry.second.stream.silent_s(); });
    if (last->second.stream.silent_s() < kActive_s) return nullptr;
    clients_.erase(last);
  }
  counts_.near += isNear(want);
  counts_.whole += want.first < blocksOf(parts_.cloud.size()) && !isNear(want);
  if (parts_.log)
    parts_.log->say("{} {}", printable(want.host),
                    isNear(want) ? "streams the points around its hands"
                    : want.edits ? "receives the edits"
                                 : "fetches the points");
  return &clients_.emplace(id, Client{.stream = {parts_.participant, parts_.topics, parts_.session, id}, .feed = {}})
              .first->second;
}

void PointServer::begin(Client& client, const Want& want) {
  const Id id = idOf(want.client);
  if (isNear(want))
    client.feed.emplace<NearFeed>(near_, id);
  else
    client.feed.emplace<WholeFeed>(WholeFeed::Parts{.cloud = parts_.cloud, .points = parts_.points, .client = id},
                                   want);
}

void PointServer::heard(const Id& client) {
  if (const auto found = clients_.find(client); found != clients_.end()) found->second.stream.heard();
}

void PointServer::show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands) {
  near_.show(std::move(frame), hands);
}

bool PointServer::isIdle() const {
  return std::ranges::none_of(clients_,
                              [](const auto& one) { return std::holds_alternative<NearFeed>(one.second.feed); });
}

// Looks up the bricks in new balls, those of the longest waiting client first. Returns 0 if some wait for the next
// round.
double PointServer::lookUp() {
  std::vector<NearFeed*> waiting;
  for (auto& [id, client] : clients_)
    if (auto* const near = std::get_if<NearFeed>(&client.feed); near && near->waitsSince()) waiting.push_back(near);
  std::ranges::sort(waiting, {}, [](const NearFeed* near) { return *near->waitsSince(); });
  const Stopwatch since;
  for (NearFeed* const near : waiting) {
    if (since.elapsed_s() > kLookUp_s) return 0;
    near->lookUp();
  }
  return kIdle_s;
}

double PointServer::write() {
  double next_s = kIdle_s;
  if (!isIdle()) {
    next_s = std::min(lookUp(), near_.update([&] {
      std::unordered_set<BrickKey> keys;
      for (const auto& [id, client] : clients_)
        if (const auto* const near = std::get_if<NearFeed>(&client.feed))
          keys.insert(near->wanted().begin(), near->wanted().end());
      return keys;
    }));
  }
  for (auto& [id, client] : clients_) next_s = std::min(next_s, write(client));
  return std::max(next_s, 0.0);
}

double PointServer::write(Client& client) {
  if (auto* const whole = std::get_if<WholeFeed>(&client.feed)) return write(client.stream, *whole);
  auto* const near = std::get_if<NearFeed>(&client.feed);
  if (!near) return kIdle_s;
  const std::uint64_t steps = near->steps();
  const double next_s = write(client.stream, *near);
  counts_.nearSteps += near->steps() - steps;
  return next_s;
}

template <class Served>
double PointServer::write(ClientStream& stream, Served& feed) {
  constexpr bool kNear = std::is_same_v<Served, NearFeed>;
  const std::uint64_t window = std::min(Served::kWindow, std::max(kMaxUnacked / clients_.size(), kMinWindow));
  for (int written = 0; written < kInTurn; ++written) {
    const ClientStream::Sent sent = stream.send(feed, window);
    if (sent == ClientStream::Sent::full) return kSoon_s;
    if (sent == ClientStream::Sent::nothing) {
      stream.probe();
      return stream.hasRoom(window) ? feed.due_s() : kIdle_s;
    }
    counts_.states += stream.last().states.size();
    if (kNear)
      counts_.nearPoints += stream.last().points.size();
    else
      counts_.blocks += !stream.last().points.empty();
  }
  return 0;
}

}  // namespace palpate::sharing
