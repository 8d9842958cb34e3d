#include "haptics/sharing/brick_server.hpp"

#include <algorithm>

#include "haptics/sharing/seen_others.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxBrickClients = 64;  // at a time; one more replaces the client that was silent for longest,
constexpr double kHandTimeout_s = 5;  // if it was silent for this long: an active client sends 20 requests a second
constexpr std::int32_t kMaxBrickRequests = 4096;  // requests
constexpr double kLooking_s = 0.005;     // per round, for looking up requested bricks: other work waits meanwhile
constexpr double kShowApart_s = 0.005;   // between two passes over a frame
constexpr double kClientTimeout_s = 30;  // a client that is silent for this long is removed
constexpr LedgerLimits kStillLimits{.known = 1 << 17, .atOnce = 1024};
constexpr LedgerLimits kMovingLimits{.known = 1 << 13, .atOnce = 1 << 13};
constexpr std::uint64_t kFewestSamples = 256, kMaxSamplesUnderWay = 1024;  // in flight to a client
constexpr double kProbe_s = 1;     // without progress for this long, a client gets an empty sample that reveals losses
constexpr double kSoon_s = 0.002;  // until a link without room is tried again
constexpr double kIdle_s = 0.05;
// Sizes within a sample, which is one Ethernet frame (messages.hpp).
constexpr std::size_t kRoom_bytes = 1200, kHead_bytes = 16, kPoint_bytes = 32, kVelocity_bytes = 12;

}  // namespace

BrickServer::BrickServer(const Parts& parts)
    : parts_(parts),
      facts_(parts.participant, parts.topics.facts, reliableQos(true)),
      nears_(parts.participant, parts.topics.nears, keepingLast(bestEffortQos(), kMaxBrickRequests)),
      bricks_(parts.facts.edge) {
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

void BrickServer::tell(const Restarts& restarts) {
  if (restarts.count == said_.restarts) return;
  said_.restarts = restarts.count;
  put(said_.why, restarts.why);
  facts_.write(said_);
}

void BrickServer::take() {
  nears_.take([&](const Near& near) {
    if (isSame(near.session, parts_.session)) take(near);
  });
  std::erase_if(clients_, [](const auto& client) { return client.second.heard.elapsed_s() > kClientTimeout_s; });
}

bool BrickServer::isWhole(const Near& near) const {
  constexpr double kFarthest = 1e30;  // fits into float32
  const std::span<const palpate_sharing_Ball> balls(near.balls._buffer, near.balls._length);
  return balls.size() <= kMaxBalls && std::ranges::all_of(balls, [](const palpate_sharing_Ball& ball) {
           return ball.radius >= 0 && ball.radius <= kFarthest &&
                  std::ranges::all_of(ball.center, [](double x) { return std::abs(x) <= kFarthest; });
         });
}

// Null if there are too many clients and all are active.
BrickServer::Client* BrickServer::clientOf(const Near& near) {
  const Id id = idOf(near.client);
  if (const auto there = clients_.find(id); there != clients_.end()) return &there->second;
  if (clients_.size() >= kMaxBrickClients) {
    const auto last =
        std::ranges::max_element(clients_, {}, [](const auto& entry) { return entry.second.heard.elapsed_s(); });
    if (last->second.heard.elapsed_s() < kHandTimeout_s) return nullptr;
    clients_.erase(last);
  }
  ++counts_.clients;
  if (parts_.log) parts_.log->say("{} streams the points around its hands", printable(near.host));
  Client& client = clients_[id];
  client.writer =
      Writer<Bricks>(parts_.participant, parts_.topics.bricks, reliableQos(false, partitionOf(near.client)));
  return &client;
}

void BrickServer::take(const Near& near) {
  Client* const known = isWhole(near) ? clientOf(near) : nullptr;
  if (!known) {
    ++counts_.refused;
    return;
  }
  Client& client = *known;
  client.heard = {};
  if (near.epoch > client.epoch) {
    client.epoch = near.epoch;
    // A client with samples of an epoch unknown here was removed, or has them from the previous server. The next sample
    // it gets does not follow those, so it requests everything again.
    client.sample = client.taken = near.taken > 0 ? near.taken + 1 : 0;
    client.window = kFewestSamples;
    client.ledger = {};
    client.outgoing.reset();
    client.unacked.clear();
    client.wantsMore = true;
    client.number = client.acked = 0;
  }
  if (near.epoch < client.epoch || near.number <= client.number) return;  // received out of order
  client.number = near.number;
  acknowledge(client, near.taken);
  std::vector<Ball> balls;
  for (std::uint32_t i = 0; i < near.balls._length; ++i) {
    const palpate_sharing_Ball& ball = near.balls._buffer[i];
    balls.push_back({.center = DVec3(ball.center[0], ball.center[1], ball.center[2]), .radius = ball.radius});
  }
  Wanted& wanted = client.wanted;
  if (balls == (wanted.asked ? *wanted.asked : wanted.balls)) return;
  if (!wanted.asked) wanted.since = Stopwatch::Clock::now();
  wanted.asked = std::move(balls);
}

// The longest waiting clients come first. Returns true if a client has to wait for the next round.
bool BrickServer::lookAround() {
  std::vector<Client*> waiting;
  for (auto& [id, client] : clients_)
    if (client.wanted.asked) waiting.push_back(&client);
  std::ranges::sort(waiting, {}, [](const Client* client) { return client->wanted.since; });
  const Stopwatch since;
  for (Client* const client : waiting) {
    if (since.elapsed_s() > kLooking_s) return true;
    Wanted& wanted = client->wanted;
    wanted.balls = std::move(*wanted.asked);
    wanted.asked.reset();
    wanted.bricks = bricksIn(wanted.balls, bricks_.grid());
    client->wantsMore = shown_.isOld = true;
  }
  return false;
}

void BrickServer::acknowledge(Client& client, std::uint64_t taken) {
  if (taken <= client.taken || taken > client.sample) return;
  client.window = std::min(kMaxSamplesUnderWay, std::max(client.window, kFewestSamples) + taken - client.taken);
  client.taken = taken;
  client.progressed = {};
  while (!client.unacked.empty() && client.unacked.front().sample <= taken) {
    client.fastest_s = std::min(client.fastest_s, client.unacked.front().since.elapsed_s());
    client.unacked.pop_front();
  }
}

void BrickServer::show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands) {
  forces_N_.clear();
  for (const SeenHand& hand : hands)
    if (hand.force_N != DVec3(0)) forces_N_[hand.number] = hand.force_N;
  shown_.frame = std::move(frame);
  shown_.isOld = true;
}

// Returns the seconds until there may be something to show.
double BrickServer::showWanted() {
  if (!shown_.frame || !shown_.isOld) return kIdle_s;
  const double wait_s = shown_.since ? kShowApart_s - shown_.since->elapsed_s() : 0;
  if (wait_s > 0) return wait_s;
  shown_.since.emplace();
  shown_.isOld = false;
  std::unordered_set<BrickKey> wanted;
  for (const auto& [id, client] : clients_) wanted.insert(client.wanted.bricks.begin(), client.wanted.bricks.end());
  bricks_.show(*shown_.frame, wanted);
  return kIdle_s;
}

// Applies the edits of a static cloud to its bricks.
void BrickServer::follow() {
  if (!isBuilt_) {
    isBuilt_ = true;
    place_.upTo = parts_.points.head();
    bricks_.build(parts_.points.points());
  }
  constexpr std::size_t kAtOnce = 4096;
  while (parts_.points.isBehind(place_)) {
    states_.clear();
    parts_.points.collect(place_, Id{}, kAtOnce, states_);
    for (const PointState& state : states_) bricks_.follow(state.number);
  }
}

double BrickServer::write() {
  if (clients_.empty()) return kIdle_s;
  if (!parts_.facts.moves) follow();
  const bool isLeft = lookAround();
  double next_s = parts_.facts.moves ? showWanted() : kIdle_s;
  if (isLeft) next_s = 0;
  constexpr int kInTurn = 64;  // samples
  for (auto& [id, client] : clients_) {
    int written = 0;
    for (; written < kInTurn && (client.outgoing || begin(id, client)); ++written)
      if (!writeSample(client)) {
        next_s = std::min(next_s, kSoon_s);
        break;
      }
    if (written == kInTurn) next_s = 0;
    probe(client);
  }
  return next_s;
}

// Moving points are useless once newer ones exist: nothing is queued on a link that is too slow for all frames.
bool BrickServer::mayBegin(const Client& client) const {
  if (client.sample - client.taken >= std::max(client.window, kFewestSamples)) return false;
  constexpr double kSlack_s = 0.06;
  return !parts_.facts.moves || client.unacked.empty() ||
         client.unacked.front().since.elapsed_s() < 1.5 * client.fastest_s + kSlack_s;
}

BrickServer::Forces BrickServer::forcesOn(const Id& client) const {
  Forces forces{};
  for (std::uint8_t hand = 0; hand < kMaxHands; ++hand)
    if (const auto on = forces_N_.find(handNumber(client, hand)); on != forces_N_.end())
      for (int axis = 0; axis < 3; ++axis) forces[3 * hand + axis] = static_cast<float>(on->second[axis]);
  return forces;
}

// Bricks were just updated: a client that has all it wants also has the results of its strokes so far.
bool BrickServer::begin(const Id& id, Client& client) {
  const std::uint64_t acked = parts_.points.lastOf(id);
  const bool isNews = client.wantsMore || client.seen != bricks_.version() || acked > client.acked;
  if (client.epoch == 0 || !isNews || !mayBegin(client)) return false;
  const bool moves = parts_.facts.moves;
  if (moves && !shown_.since) return false;
  Outgoing going{.step = client.ledger.next(client.wanted.balls, client.wanted.bricks, bricks_,
                                            moves ? kMovingLimits : kStillLimits),
                 .forces = forcesOn(id),
                 .true_s = bricks_.true_s(),
                 .acked = client.acked};
  client.wantsMore = !going.step.whole;
  client.seen = bricks_.version();
  if (going.step.whole) going.acked = acked;
  // A force that does not change is sent again, or it would count as old.
  const bool isFelt = going.forces != Forces{} || going.forces != client.forces;
  if (going.step.isEmpty() && going.acked == client.acked && !isFelt) return false;
  client.acked = going.acked;
  client.forces = going.forces;
  client.outgoing = std::move(going);
  ++counts_.steps;
  return true;
}

void BrickServer::fill(Bricks& sample, Outgoing& going) {
  heads_.clear();
  ids_.clear();
  points_.clear();
  velocities_.clear();
  std::size_t room = kRoom_bytes;
  if (going.forces != Forces{}) room -= sizeof going.forces;
  const BrickLedger::Step& step = going.step;
  for (; going.gone.dropped < step.dropped.size() && room >= kHead_bytes; ++going.gone.dropped, room -= kHead_bytes)
    heads_.push_back({.key = step.dropped[going.gone.dropped], .total = kBrickDropped, .count = 0});
  while (going.gone.brick < step.bricks.size() && room >= kHead_bytes) {
    const auto& [key, brick] = step.bricks[going.gone.brick];
    const bool moves = !brick->velocities.empty();
    const std::size_t each = kPoint_bytes + (moves ? kVelocity_bytes : 0);
    const std::size_t count = std::min(brick->size() - going.gone.point, (room - kHead_bytes) / each);
    if (count == 0 && brick->size() > 0) break;
    heads_.push_back(
        {.key = key, .total = static_cast<std::uint32_t>(brick->size()), .count = static_cast<std::uint32_t>(count)});
    for (std::size_t i = going.gone.point; i < going.gone.point + count; ++i) {
      Point point{};
      for (int axis = 0; axis < 3; ++axis) {
        point.position[axis] = brick->positions[i][axis];
        point.normal[axis] = brick->normals[i][axis];
        if (moves) velocities_.push_back(brick->velocities[i][axis]);
      }
      if (!brick->colors.empty()) point.color = brick->colors[i];
      ids_.push_back(brick->ids[i]);
      points_.push_back(point);
    }
    room -= kHead_bytes + count * each;
    going.gone.point += count;
    if (going.gone.point < brick->size()) break;
    ++going.gone.brick;
    going.gone.point = 0;
  }
  const auto give = [](auto& to, auto& from) {
    to._buffer = from.data();
    to._length = to._maximum = static_cast<std::uint32_t>(from.size());
  };
  give(sample.parts, heads_);
  give(sample.ids, ids_);
  give(sample.points, points_);
  give(sample.velocities, velocities_);
  if (going.forces != Forces{}) give(sample.forces, going.forces);
}

bool BrickServer::writeSample(Client& client) {
  Outgoing& going = *client.outgoing;
  const Gone before = going.gone;
  Bricks sample{};
  set(sample.session, parts_.session);
  sample.epoch = client.epoch;
  sample.sample = client.sample + 1;
  sample.true_s = going.true_s;
  sample.whole = going.step.whole;
  sample.acked = going.acked;
  fill(sample, going);
  sample.last = going.gone.dropped == going.step.dropped.size() && going.gone.brick == going.step.bricks.size();
  if (!client.writer.write(sample)) {
    going.gone = before;
    return false;
  }
  if (client.sample == client.taken) client.progressed = {};
  ++client.sample;
  ++counts_.samples;
  counts_.points += ids_.size();
  if (sample.last) {
    client.unacked.push_back({.sample = client.sample, .since = {}});
    client.outgoing.reset();
  }
  return true;
}

// A client that missed samples notices by the number of the next one, and requests everything again.
void BrickServer::probe(Client& client) {
  if (client.sample == client.taken || client.outgoing || client.progressed.elapsed_s() < kProbe_s) return;
  Bricks sample{};
  set(sample.session, parts_.session);
  sample.epoch = client.epoch;
  sample.sample = client.sample + 1;
  if (client.writer.write(sample)) ++client.sample;
  client.progressed = {};
}

}  // namespace palpate::sharing
