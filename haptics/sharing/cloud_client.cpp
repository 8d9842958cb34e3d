#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"
#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/far_link.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/wanted_points.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kEndPoll_s = 0.05;      // how often a requested stop is checked
constexpr double kSecondServer_s = 0.3;  // time to find another session of the same name

/// Receives the points of a session, block by block, and the edits since, if they are wanted.
class Fetch {
 public:
  /// `every`: fetches each n-th point.
  Fetch(const JoinedSession& session, const SessionNotice& notice, const JoinOptions& options, std::uint32_t every,
        bool edits)
      : notice_(notice),
        options_(options),
        count_((notice.points + every - 1) / every),
        stream_(session.participant, session.topics, notice.session, freshId()),
        wait_(session.participant),
        wanted_{.every = every, .edits = edits} {
    stream_.attach(wait_);
    joined_.cloud.origin = notice.origin;
    joined_.mm_per_unit = notice.mm_per_unit;
    joined_.host = notice.host;
    joined_.model = notice.model;
    begin();
  }

  JoinedCloud run() {
    while (received() < count_ || (wanted_.edits && !isWhole_)) {
      if (options_.stop && options_.stop()) throw NetworkError("interrupted after {} of {} points", received(), count_);
      wanted_.taken = order_.taken();
      stream_.ask(wanted_);
      wait_.sleep(kEndPoll_s);
      bool gap = false;
      stream_.take([&](const Points& sample) { gap = gap || take(sample) == Heard::gap; });
      if (gap) begin();
      if (lastCame_.elapsed_s() > options_.timeout_s)
        throw NetworkError("'{}' of {}: nothing received for {:.0f} s, after {} of {} points{}; is it still served?",
                           notice_.name, notice_.host, options_.timeout_s, received(), count_,
                           received() < count_ ? "" : ", before all edits");
      if (options_.log && count_ > 0)
        options_.log->progress(notice_.name, static_cast<double>(received()) / static_cast<double>(count_));
    }
    wanted_.taken = order_.taken();
    stream_.ask(wanted_);  // lets the server end the stream
    if (options_.log) options_.log->endProgress();
    if (wanted_.every == 1 && sharing::checksumOf(joined_.cloud) != notice_.checksum)
      throw NetworkError("'{}' of {}: the received points are not those that were announced", notice_.name,
                         notice_.host);
    if (wanted_.edits) joined_.cloud = editedCloud(joined_.cloud, states_);
    return std::move(joined_);
  }

 private:
  std::uint64_t received() const { return joined_.cloud.size(); }

  // Begins the stream, or begins it again from what is here.
  void begin() {
    wanted_.epoch = order_.begin();
    wanted_.first = static_cast<std::uint32_t>(blocksOf(received()));
    states_.clear();
  }

  Heard take(const Points& sample) {
    const Heard heard = order_.judge(sample.epoch, sample.sample);
    if (heard != Heard::taken) return heard;
    if (sample.points._length > 0 && !isIntact(sample)) return Heard::gap;
    order_.take();
    lastCame_ = {};
    if (sample.points._length > 0) addBlock({sample.points._buffer, sample.points._length});
    if (wanted_.edits && received() == count_) addEdits(sample);
    return heard;
  }

  // A damaged block is requested again, a few times.
  bool isIntact(const Points& sample) {
    const std::uint64_t number = blocksOf(received());
    const std::span<const Point> block(sample.points._buffer, sample.points._length);
    if (sample.parts._length == 1 && sample.parts._buffer->key == number &&
        sample.parts._buffer->checksum == sharing::checksumOf(block)) {
      damaged_ = 0;
      return true;
    }
    if (++damaged_ >= kMaxDamaged)
      throw NetworkError("'{}' of {}: block {} of its points was received {} times, and was damaged each time",
                         notice_.name, notice_.host, number, damaged_);
    return false;
  }

  void addBlock(std::span<const Point> block) {
    const std::uint64_t number = blocksOf(received());
    const std::uint32_t count = received() < count_ ? pointsIn(number, count_) : 0;
    if (block.size() != count)
      throw NetworkError("'{}' of {}: block {} has {} points instead of {}", notice_.name, notice_.host, number,
                         block.size(), count);
    PointCloud& cloud = joined_.cloud;
    for (const Point& point : block) {
      if (!isValid(point))
        throw NetworkError("'{}' of {}: point {} is invalid: it has no position or no normal", notice_.name,
                           notice_.host, received());
      cloud.positions.emplace_back(point.position[0], point.position[1], point.position[2]);
      cloud.normals.emplace_back(point.normal[0], point.normal[1], point.normal[2]);
      if (notice_.colored) cloud.colors.push_back(unpackedColor(point.color));
    }
  }

  void addEdits(const Points& sample) {
    if (states_.empty()) states_ = statesOf(joined_.cloud);
    const std::optional<Results> results = resultsOf(sample, count_, come_);
    if (!results) throw NetworkError("'{}' of {}: an edit is invalid", notice_.name, notice_.host);
    for (const PointState& state : come_) states_[state.number] = state;
    isWhole_ = sample.whole && sample.upTo == sample.head;
  }

  const SessionNotice& notice_;
  const JoinOptions& options_;
  std::uint64_t count_;  // of the points to fetch
  WantedPoints stream_;
  ReaderWait wait_;
  Wanted wanted_;
  SampleOrder order_;
  JoinedCloud joined_;
  std::vector<PointState> states_, come_;  // as edited
  bool isWhole_ = false;
  int damaged_ = 0;  // times in a row that the next block was damaged
  Stopwatch lastCame_;
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

// For a cloud streamed around the hands: a subsample for orientation.
std::uint32_t everyFor(std::uint64_t points) {
  constexpr std::uint64_t kOverview = 8192;
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (points + kOverview - 1) / kOverview));
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
  const std::uint32_t every = isNear && facts->standing == 0 ? everyFor(notice.points) : 1;
  const bool edits = options.present && notice.sculptable && !isNear;
  JoinedCloud joined = Fetch(*session, notice, options, every, edits).run();
  joined.sculptable = notice.sculptable && !isNear;
  describe(joined.cloud, facts->file);
  joined.unsent = facts->file.unsent;
  if (isNear) {
    joined.facts = facts;
    joined.far = openFarCloud({.session = session, .notice = notice, .facts = *facts, .log = options.log});
  }
  joined.session = std::move(session);
  return joined;
}

NetworkSurvey discoverSessions(const NetworkConfig& network, double seconds, const StopSign& stop) {
  const Participant participant(network);
  const Topics topics(participant);
  SessionNotices notices(participant, topics);
  const Writer<Ping> pings(participant, topics.pings, bestEffortQos());
  const Reader<Ping> echoes(participant, topics.pings, bestEffortQos(kEchoes));
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
