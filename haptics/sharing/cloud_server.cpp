#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "haptics/sharing/brick_server.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/motion_thread.hpp"
#include "haptics/sharing/session_name.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/stroke_server.hpp"
#include "haptics/sharing/version_watch.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMaxFollowers = 64;    // at a time; one more replaces the client that was idle for longest,
constexpr double kFollowerTimeout_s = 5;     // if it was idle for this long: waiting clients ask again sooner
constexpr double kFull_s = 0.002;            // until links without room are tried again
constexpr std::int32_t kMaxRequests = 4096;  // requests and pings queued
// Blocks kept for clients that may not have them yet, 1.4 KB each: maximum of all together, and what each client may
// have in any case.
constexpr std::uint64_t kMaxUnacked = 65'536, kMinUnacked = 512;
constexpr double kServerPoll_s = 0.05;  // how often a requested stop is checked
constexpr double kFrameLook_s = 0.004;  // how often a new frame is looked for

void requireSessionName(const std::string& name) {
  if (name.empty() || name.size() > kLongestName || printable(name.c_str()) != name)
    throw UsageError("name: '{}' is not a valid session name: 1 to {} bytes without control characters",
                     printable(name.c_str()), kLongestName);
}

FarFacts factsOf(const PointCloud& cloud, const CloudServer::Parts& parts) {
  FarFacts facts = parts.facts.value_or(FarFacts{});
  if (!parts.facts) {
    const SpacingRange spacing = spacingRange(cloud);
    facts = {.spacing = spacing.mean, .wideSpacing = spacing.wide, .noise = spacing.noise, .up = findUp(cloud).up};
  }
  facts.extent = {.bounds = boundsOf(cloud), .points = cloud.size()};
  // A brick has some hundred points of a surface or some dozen particles; the cloud's longest side has at most
  // kMaxAlongSide bricks.
  constexpr double kSpacings = 16, kSpacingsOfMatter = 4, kMaxAlongSide = 1 << 18;
  facts.edge = std::max((facts.matter.empty() ? kSpacings : kSpacingsOfMatter) * facts.spacing,
                        facts.extent.bounds.longestSide() / kMaxAlongSide);
  if (!(facts.edge > 0)) facts.edge = 1;
  facts.moves = static_cast<bool>(parts.motion);
  return facts;
}

}  // namespace

struct CloudServer::Link {
  struct Range {
    std::uint32_t first, end, every;
  };
  struct Client {
    Writer<Block> blocks;  // in its partition
    Stopwatch lastAsked;
    std::uint64_t unacked = 0;  // blocks written since all were acknowledged; an upper bound
    std::deque<Range> asked;    // not written yet; written as fast as the link accepts them
  };

  Link(const PointCloud& served, Parts given)
      : cloud(served),
        parts(std::move(given)),
        participant(parts.network),
        topics(participant),
        name(participant, topics, parts.name, parts.log),
        echoes(participant, topics.echoes, bestEffortQos()),
        requests(participant, topics.requests, keepingLast(reliableQos(false), kMaxRequests)),
        pings(participant, topics.pings, keepingLast(bestEffortQos(), kMaxRequests)),
        versions(participant),
        wait(participant),
        shared(statesOf(cloud)) {
    wait.attach(requests);
    wait.attach(pings);
    if (parts.sculptable) goOn();
    near.emplace(BrickServer::Parts{.participant = participant,
                                    .topics = topics,
                                    .session = session,
                                    .facts = factsOf(cloud, parts),
                                    .file = servedFileOf(cloud),
                                    .points = shared,
                                    .log = parts.log});
    near->attach(wait);
    if (parts.motion)
      moving.emplace(MotionThread::Parts{.motion = parts.motion,
                                         .rate_Hz = parts.motion_Hz,
                                         .cloud = cloud,
                                         .participant = participant,
                                         .topics = topics,
                                         .session = session});
  }

  // Resumes from the journal, if there is one.
  void goOn() {
    if (!parts.journal.empty()) {
      journal.emplace(
          parts.journal, cloud.size(), sharing::checksumOf(cloud), session, [&](const StrokeJournal::Piece& piece) {
            if (shared.take(piece.client, piece.number, piece.states) != SharedPoints::Taken::taken)
              throw FileError(parts.journal, "is damaged: a piece of a stroke does not follow those before it");
          });
      session = journal->session();
      if (parts.log && journal->pieces() > 0)
        parts.log->say("{}: continues with {} of strokes", parts.journal.string(), counted(journal->pieces(), "piece"));
      if (parts.log && journal->tornBytes() > 0)
        parts.log->say("{}: its last {} bytes were an incomplete piece and are removed; its client sends it again",
                       parts.journal.string(), journal->tornBytes());
    }
    strokes.emplace(StrokeServer::Parts{.participant = participant,
                                        .topics = topics,
                                        .session = session,
                                        .points = shared,
                                        .journal = journal ? &*journal : nullptr,
                                        .log = parts.log});
    strokes->attach(wait);
  }

  // A client of another version learns so from the notice (Notice::version); this logs it at the server.
  void sayVersions() {
    for (const std::uint32_t other : versions.fresh())
      if (parts.log)
        parts.log->say(
            "{}: another version of palpate ({}, and this is {}) is on the network and cannot join; install the same "
            "one on both",
            parts.name, other, kVersion);
  }

  void announce() {
    name.requireFree(parts.stop);
    Notice notice{};
    set(notice.session, session);
    notice.version = kVersion;
    put(notice.name, parts.name);
    put(notice.host, ownHost());
    put(notice.model, printable(parts.model.c_str()));
    notice.points = cloud.size();
    for (int axis = 0; axis < 3; ++axis) notice.origin[axis] = cloud.origin[axis];
    notice.mm_per_unit = parts.mm_per_unit;
    notice.colored = cloud.hasColors();
    notice.sculptable = parts.sculptable;
    notice.checksum = sharing::checksumOf(cloud);
    name.announce(notice);
  }

  // Null if there are too many clients and all are active.
  Client* clientOf(const Request& request) {
    const Id id = idOf(request.client);
    if (const auto there = clients.find(id); there != clients.end()) return &there->second;
    if (clients.size() >= kMaxFollowers) {
      const auto last =
          std::ranges::max_element(clients, {}, [](const auto& entry) { return entry.second.lastAsked.elapsed_s(); });
      if (last->second.lastAsked.elapsed_s() < kFollowerTimeout_s) return nullptr;
      unacked -= last->second.unacked;
      clients.erase(last);
    }
    ++counts.clients;
    if (parts.log) parts.log->say("{}: {} fetches the points", parts.name, printable(request.host));
    Client client;
    client.blocks = Writer<Block>(participant, topics.blocks, reliableQos(false, partitionOf(request.client)));
    return &clients.emplace(id, std::move(client)).first->second;
  }

  void answer(const Request& request) {
    if (!isSame(request.session, session)) return;  // another server's
    const std::uint32_t every = std::max(1U, request.every);
    const std::uint64_t blocks = blocksOf((cloud.size() + every - 1) / every);
    if (request.count == 0 || request.count > kMaxRequested || request.first >= blocks ||
        request.count > blocks - request.first) {
      ++counts.refused;
      return;
    }
    Client* const client = clientOf(request);
    if (!client) {
      ++counts.refused;
      return;
    }
    ++counts.requests;
    client->lastAsked = {};
    constexpr std::size_t kMaxRanges = 64;  // a client with more requests pending keeps the last ones
    if (client->asked.size() >= kMaxRanges) client->asked.pop_front();
    client->asked.push_back({request.first, request.first + request.count, every});
  }

  // Some blocks for each client in turn, as long as its link accepts them. Returns the seconds until there is more to
  // do.
  double write() {
    constexpr std::uint32_t kInTurn = 64;  // blocks
    bool isLeft = false;
    const std::uint64_t before = counts.blocks;
    if (unacked >= kMaxUnacked) countUnacked();
    for (auto& [id, client] : clients) {
      for (std::uint32_t i = 0; i < kInTurn && !client.asked.empty(); ++i) {
        Range& range = client.asked.front();
        if (unacked >= kMaxUnacked && client.unacked >= kMinUnacked) break;
        if (!writeBlock(client, range.first, range.every)) break;
        ++unacked;
        ++client.unacked;
        if (++range.first == range.end) client.asked.pop_front();
      }
      isLeft = isLeft || !client.asked.empty();
    }
    return !isLeft ? kServerPoll_s : counts.blocks == before ? kFull_s : 0;
  }

  // DDS no longer keeps blocks that all their readers have received.
  void countUnacked() {
    unacked = 0;
    for (auto& [id, client] : clients) {
      if (client.blocks.isAcked()) client.unacked = 0;
      unacked += client.unacked;
    }
  }

  bool writeBlock(const Client& client, std::uint32_t number, std::uint32_t every) {
    const std::uint32_t count = pointsIn(number, (cloud.size() + every - 1) / every);
    points.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t at = (std::size_t{number} * kBlockPoints + i) * every;
      for (int axis = 0; axis < 3; ++axis) {
        points[i].position[axis] = cloud.positions[at][axis];
        points[i].normal[axis] = cloud.normals[at][axis];
      }
      points[i].color = packedColor(cloud, at);
    }
    Block block{};
    set(block.session, session);
    block.number = number;
    block.every = every;
    give(block.points, points);
    const bool isWritten = client.blocks.write(block);
    counts.blocks += isWritten;
    return isWritten;
  }

  const PointCloud& cloud;
  Parts parts;
  Participant participant;
  Topics topics;
  Id session = freshId();
  SessionName name;
  Writer<Ping> echoes;
  Reader<Request> requests;
  Reader<Ping> pings;
  VersionWatch versions;
  ReaderWait wait;
  std::map<Id, Client> clients;
  std::uint64_t unacked = 0;  // of all clients
  std::vector<Point> points;  // of the block that is being written
  SharedPoints shared;
  std::optional<StrokeJournal> journal;
  std::optional<StrokeServer> strokes;
  std::optional<BrickServer> near;
  std::optional<MotionThread> moving;
  ServedCounts counts;
};

CloudServer::CloudServer(const PointCloud& cloud, Parts parts) {
  requireSessionName(parts.name);
  if (parts.facts && parts.facts->matter.size() >= sizeof(Facts::matter))
    throw UsageError("matter: a scene of {} bytes is too long to be announced", parts.facts->matter.size());
  if (parts.motion && parts.sculptable) throw UsageError("sculptable: a session that moves cannot be sculpted");
  PALPATE_CHECK(cloud.hasNormals() || cloud.empty());
  constexpr std::uint64_t kMaxPoints = std::uint64_t{0xffffffff} * kBlockPoints;
  PALPATE_CHECK_LT(cloud.size(), kMaxPoints);
  link_ = std::make_unique<Link>(cloud, std::move(parts));
  link_->announce();
}

CloudServer::~CloudServer() = default;

void CloudServer::serve(const std::atomic<bool>& stop, double seconds) {
  const Stopwatch since;
  double next_s = 0;
  while (!stop && !(seconds > 0 && since.elapsed_s() >= seconds)) {
    if (next_s > 0) link_->wait.sleep(std::min(kServerPoll_s, next_s));
    link_->pings.take([&](const Ping& ping) {
      if (!isSame(ping.session, link_->session)) return;
      link_->echoes.write(ping);
      ++link_->counts.pings;
      if (link_->strokes) link_->strokes->heard(idOf(ping.client));
    });
    link_->sayVersions();
    link_->name.watch();
    link_->requests.take([&](const Request& request) { link_->answer(request); });
    if (link_->strokes) link_->strokes->take();
    next_s = link_->write();
    if (link_->strokes) next_s = std::min(next_s, link_->strokes->write());
    if (link_->parts.restarts) link_->near->tell(link_->parts.restarts());
    link_->near->take();
    if (link_->moving)
      if (auto moved = link_->moving->newest(); moved.frame) link_->near->show(std::move(moved.frame), moved.hands);
    next_s = std::min(next_s, link_->near->write());
    if (link_->moving && !link_->near->isIdle()) next_s = std::min(next_s, kFrameLook_s);
  }
}

ServedCounts CloudServer::counts() const {
  ServedCounts counts = link_->counts;
  const BrickCounts& near = link_->near->counts();
  counts.partial = near.clients;
  counts.partialPoints = near.points;
  counts.partialSteps = near.steps;
  counts.refused += near.refused;
  if (link_->moving) counts.frames = link_->moving->frames();
  if (!link_->strokes) return counts;
  const StrokeTally& strokes = link_->strokes->counts();
  counts.sculptors = strokes.sculptors;
  counts.pieces = strokes.pieces;
  counts.states = strokes.states;
  counts.again = strokes.again;
  counts.refused += strokes.refused;
  counts.sent = strokes.sent;
  return counts;
}

std::span<const PointState> CloudServer::points() const { return link_->shared.points(); }

}  // namespace palpate
