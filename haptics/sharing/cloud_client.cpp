#include <algorithm>
#include <cmath>
#include <optional>
#include <thread>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"
#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/far_link.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kEndPoll_s = 0.05;      // how often a requested stop is checked
constexpr double kAskAgain_s = 3;        // until missing blocks are requested again; DDS itself resends lost frames
constexpr double kSecondServer_s = 0.3;  // time to find another session of the same name
constexpr double kFewestAhead = 64, kMaxAhead = 4096;  // blocks requested and not received

/// Fetches the points of a session, block by block.
class Fetch {
 public:
  /// `every`: fetches each n-th point.
  Fetch(const Participant& participant, const Topics& topics, const SessionNotice& notice, const JoinOptions& options,
        std::uint64_t every)
      : notice_(notice),
        every_(every),
        points_((notice.points + every - 1) / every),
        options_(options),
        requests_(participant, topics.requests, reliableQos(false)),
        wait_(participant),
        blocks_(blocksOf(points_)) {
    std::uint8_t own[16];
    set(own, client_);
    reader_ = Reader<Block>(participant, topics.blocks, reliableQos(false, partitionOf(own)));
    wait_.attach(reader_);
    joined_.cloud.origin = notice.origin;
    joined_.mm_per_unit = notice.mm_per_unit;
    joined_.host = notice.host;
    joined_.model = notice.model;
  }

  JoinedCloud run() {
    while (complete_ < blocks_) {
      if (options_.stop && options_.stop()) throw NetworkError("interrupted after {} of {} points", taken_, points_);
      ask();
      wait_.sleep(kEndPoll_s);
      const std::uint64_t before = taken_;
      reader_.take([&](const Block& block) { take(block); });
      if (taken_ != before) lastCame_ = {};
      if (lastCame_.elapsed_s() > options_.timeout_s)
        throw NetworkError("'{}' of {}: nothing received for {:.0f} s, after {} of {} points; is it still served?",
                           notice_.name, notice_.host, options_.timeout_s, taken_, points_);
      if (options_.log && points_ > 0)
        options_.log->progress(notice_.name, static_cast<double>(taken_) / static_cast<double>(points_));
    }
    if (options_.log) options_.log->endProgress();
    if (every_ == 1 && sharing::checksumOf(joined_.cloud) != notice_.checksum)
      throw NetworkError("'{}' of {}: the received points are not those that were announced", notice_.name,
                         notice_.host);
    return std::move(joined_);
  }

 private:
  // Requests as much ahead as the link has carried so far; blocks that were not received in time are requested again.
  void ask() {
    const bool again = lastAsked_.elapsed_s() > kAskAgain_s && lastCame_.elapsed_s() > kAskAgain_s;
    if (again) ahead_ = std::max(kFewestAhead, ahead_ / 2);
    const std::uint64_t end = std::min(blocks_, complete_ + static_cast<std::uint64_t>(ahead_));
    const std::uint64_t begin = again ? complete_ : asked_;
    // A quarter of `ahead_` at a time: a request costs as much as a frame.
    if (end <= begin || (!again && static_cast<double>(end - begin) < ahead_ / 4 && end != blocks_)) return;
    Request request{};
    set(request.session, notice_.session);
    set(request.client, client_);
    put(request.host, host_);
    request.first = static_cast<std::uint32_t>(begin);
    request.count = static_cast<std::uint32_t>(end - begin);
    request.every = static_cast<std::uint32_t>(every_);
    if (requests_.write(request)) asked_ = std::max(asked_, end);
    lastAsked_ = {};
    came_.resize(std::max(came_.size(), static_cast<std::size_t>(end)), 0);
    const std::size_t points = static_cast<std::size_t>(std::min(points_, end * kBlockPoints));
    if (joined_.cloud.positions.size() >= points) return;
    joined_.cloud.positions.resize(points);
    joined_.cloud.normals.resize(points);
    if (notice_.colored) joined_.cloud.colors.resize(points);
  }

  void take(const Block& block) {
    if (!isSame(block.session, notice_.session) || block.every != every_ || block.number >= came_.size() ||
        came_[block.number])
      return;
    const std::uint32_t count = pointsIn(block.number, points_);
    if (block.points._length != count)
      throw NetworkError("'{}' of {}: block {} has {} points instead of {}", notice_.name, notice_.host, block.number,
                         block.points._length, count);
    PointCloud& cloud = joined_.cloud;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Point& point = block.points._buffer[i];
      const std::size_t at = std::size_t{block.number} * kBlockPoints + i;
      cloud.positions[at] = Vec3(point.position[0], point.position[1], point.position[2]);
      cloud.normals[at] = Vec3(point.normal[0], point.normal[1], point.normal[2]);
      if (notice_.colored)
        for (unsigned k = 0; k < 4; ++k) cloud.colors[at][k] = static_cast<std::uint8_t>(point.color >> (8 * k));
      constexpr double kLongest = 1.01;  // maximum length of a unit normal
      if (!isFinite(DVec3(cloud.positions[at])) || !(glm::length(cloud.normals[at]) < kLongest))
        throw NetworkError("'{}' of {}: point {} is invalid: it has no position or no normal", notice_.name,
                           notice_.host, at);
    }
    came_[block.number] = 1;
    ahead_ = std::min(kMaxAhead, ahead_ + 1);  // doubles with each round trip: fills a link without flooding it
    taken_ += count;
    while (complete_ < came_.size() && came_[complete_]) ++complete_;
  }

  const SessionNotice& notice_;
  std::uint64_t every_, points_;  // points_: number to fetch
  const JoinOptions& options_;
  Id client_ = freshId();
  std::string host_ = ownHost();
  Writer<Request> requests_;
  Reader<Block> reader_;
  ReaderWait wait_;
  JoinedCloud joined_;
  std::uint64_t blocks_;                    // total
  std::uint64_t asked_ = 0, complete_ = 0;  // all blocks before it are requested, received
  std::uint64_t taken_ = 0;                 // points
  double ahead_ = kFewestAhead;
  std::vector<std::uint8_t> came_;
  Stopwatch lastAsked_, lastCame_;
};

// Hint that programs with keys are present: without their keys this program cannot receive from them.
std::string keyHoldersInWords(dds_entity_t participant, const NetworkConfig& network) {
  if (!seesKeyHolders(participant)) return {};
  return network.security.empty()
             ? "; there are programs with keys, and this one has none"
             : "; there are programs with keys: are they of the authority of " + network.security + "?";
}

SessionNotice find(const std::string& name, const Participant& participant, const Topics& topics,
                   const JoinOptions& options) {
  SessionNotices notices(participant, topics);
  const Stopwatch since;
  std::vector<SessionNotice> known;
  do {
    if (options.stop && options.stop()) throw NetworkError("interrupted while searching for '{}'", name);
    known = notices.listenFor(name, kEndPoll_s);
  } while (std::ranges::find(known, name, &SessionNotice::name) == known.end() &&
           since.elapsed_s() < options.timeout_s);
  known = notices.listen(kSecondServer_s, options.stop);
  std::vector<SessionNotice> same;
  std::string others;
  for (SessionNotice& notice : known) {
    if (notice.name == name)
      same.push_back(std::move(notice));
    else
      others += (others.empty() ? "; there are '" : "', '") + notice.name;
  }
  if (same.empty())
    throw NetworkError("no session named '{}' is served on {}{}{}", printable(name.c_str()),
                       options.network.interface.empty() ? "this machine (another network has to be named)"
                                                         : "the network of " + options.network.interface,
                       others.empty() ? others : others + "'", keyHoldersInWords(participant, options.network));
  if (same.size() > 1)
    throw NetworkError("two sessions are named '{}', of {} and of {}; end one of them, or give it another name", name,
                       same[0].host, same[1].host);
  const SessionNotice& found = same.front();
  if (found.version != kVersion)
    throw NetworkError(
        "'{}' of {} is served by another version of palpate ({}, and this is {}); install the same one on both", name,
        found.host, found.version, kVersion);
  constexpr std::uint64_t kMaxPoints = std::uint64_t{1} << 32;
  constexpr double kMinScale = 1e-12, kMaxScale = 1e12;  // mm per unit
  if (!isFinite(found.origin) || !(found.mm_per_unit >= kMinScale && found.mm_per_unit <= kMaxScale) ||
      found.points > kMaxPoints)
    throw NetworkError("'{}' of {} announces an invalid cloud", name, found.host);
  return found;
}

// Applies the edits made so far, once.
void bringUpToDate(PointCloud& cloud, const JoinedSession& session, const JoinOptions& options) {
  const Writer<ResumeRequest> requests(session.participant, session.topics.resumes, reliableQos(false));
  std::uint8_t own[16];
  set(own, session.client);
  const Reader<Result> results(session.participant, session.topics.results, reliableQos(false, partitionOf(own)));
  ReaderWait wait(session.participant);
  wait.attach(results);
  EditExchange exchange(statesOf(cloud), 1);
  std::vector<PointState> states = statesOf(cloud), come;
  const auto ask = [&] { requests.write(requestOf(session, exchange.resume())); };
  ask();
  Stopwatch lastCame, lastAsked;
  for (bool isWhole = false; !isWhole;) {
    throwIfStopped(options.stop);
    wait.sleep(kEndPoll_s);
    bool again = lastAsked.elapsed_s() > kAskAgain_s && lastCame.elapsed_s() > kAskAgain_s;
    results.take([&](const Result& result) {
      const std::optional<Results> said = resultsOf(session, result, states.size(), come);
      if (!said) return;
      const EditExchange::Heard heard = exchange.hear(*said);
      if (heard == EditExchange::Heard::gap) again = true;
      if (heard != EditExchange::Heard::taken) return;
      lastCame = {};
      for (const PointState& state : come) states[state.number] = state;
      isWhole = isWhole || result.upTo == result.head;
    });
    if (lastCame.elapsed_s() > options.timeout_s)
      throw NetworkError("'{}' of {}: its edits were not received within {:.0f} s", session.name, session.host,
                         options.timeout_s);
    if (!again || isWhole) continue;
    ask();
    lastAsked = {};
  }
  cloud = editedCloud(cloud, states);
}

// For a cloud streamed around the hands: a subsample for orientation.
std::uint64_t everyFor(std::uint64_t points) {
  constexpr std::uint64_t kOverview = 8192;
  return std::max<std::uint64_t>(1, (points + kOverview - 1) / kOverview);
}

}  // namespace

JoinedCloud joinCloud(const std::string& name, const JoinOptions& options) {
  auto session = std::make_shared<JoinedSession>(options.network, Id{}, freshId());
  const SessionNotice notice = find(name, session->participant, session->topics, options);
  session->session = notice.session;
  session->name = notice.name;
  session->host = notice.host;
  session->sculptable = notice.sculptable;
  session->checksum = notice.checksum;
  const std::optional<HeardFacts> facts = hearFacts(*session, options.timeout_s, options.stop);
  if (!facts || facts->extent.points != notice.points)
    throw NetworkError("'{}' of {}: does not describe its model; is it still served?", notice.name, notice.host);
  const bool isNear = options.partial || (facts->moves && !options.present);
  // Bodies that stand in matter are not subsampled.
  const std::uint64_t every = isNear && facts->standing == 0 ? everyFor(notice.points) : 1;
  JoinedCloud joined = Fetch(session->participant, session->topics, notice, options, every).run();
  joined.sculptable = notice.sculptable && !isNear;
  describe(joined.cloud, facts->file);
  joined.unsent = facts->file.unsent;
  if (isNear) {
    joined.facts = facts;
    joined.far = openFarCloud({.session = session, .notice = notice, .facts = *facts, .log = options.log});
  } else if (options.present && notice.sculptable)
    bringUpToDate(joined.cloud, *session, options);
  joined.session = std::move(session);
  return joined;
}

NetworkSurvey discoverSessions(const NetworkConfig& network, double seconds, const StopSign& stop) {
  const Participant participant(network);
  const Topics topics(participant);
  SessionNotices notices(participant, topics);
  const Writer<Ping> pings(participant, topics.pings, bestEffortQos());
  const Reader<Ping> echoes(participant, topics.echoes, bestEffortQos());
  ReaderWait wait(participant);
  wait.attach(echoes);
  const std::vector<SessionNotice> known = notices.listen(seconds, stop);
  const Id client = freshId();
  NetworkSurvey survey{.sessions = {}, .keyHolders = seesKeyHolders(participant)};
  std::vector<ServedSession>& seen = survey.sessions;
  for (const SessionNotice& notice : known)
    seen.push_back({.name = notice.name,
                    .host = notice.host,
                    .model = notice.model,
                    .points = notice.points,
                    .version = notice.version,
                    .compatible = notice.version == kVersion});
  // Like a hand's poses: one after the other, without waiting for the echo of the last one.
  constexpr std::uint32_t kPings = 50;
  constexpr double kApart_s = 0.01, kLongestTrip_s = 2;
  std::vector<std::vector<double>> trips_us(known.size());
  std::vector<std::vector<std::uint8_t>> came(known.size(), std::vector<std::uint8_t>(kPings, 0));
  const Stopwatch since;
  std::uint32_t sent = 0;
  const auto isAwaited = [&] {
    for (std::size_t i = 0; i < known.size(); ++i)
      if (seen[i].compatible && seen[i].answered < kPings) return true;
    return false;
  };
  while (sent < kPings || (isAwaited() && since.elapsed_s() < kPings * kApart_s + kLongestTrip_s)) {
    throwIfStopped(stop);
    if (sent < kPings && since.elapsed_s() >= sent * kApart_s) {
      for (std::size_t i = 0; i < known.size(); ++i) {
        if (!seen[i].compatible) continue;
        Ping ping{};
        set(ping.session, known[i].session);
        set(ping.client, client);
        ping.number = sent;
        ping.sent_us = since.elapsed_us();
        pings.write(ping);
        ++seen[i].pings;
      }
      ++sent;
    }
    wait.sleep(sent < kPings ? std::max(0.0, sent * kApart_s - since.elapsed_s()) : 0.05);
    echoes.take([&](const Ping& echo) {
      const double trip_us = since.elapsed_us() - echo.sent_us;
      for (std::size_t i = 0; i < known.size(); ++i) {
        if (!isSame(echo.session, known[i].session) || !isSame(echo.client, client)) continue;
        if (echo.number >= sent || std::exchange(came[i][echo.number], std::uint8_t{1})) continue;
        ++seen[i].answered;
        if (trip_us >= 0) trips_us[i].push_back(trip_us);
      }
    });
  }
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!trips_us[i].empty()) seen[i].roundTrip_ms = summarize(trips_us[i]).p50 * 1e-3;
  return survey;
}

}  // namespace palpate
