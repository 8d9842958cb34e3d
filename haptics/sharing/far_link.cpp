#include "haptics/sharing/far_link.hpp"

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/sharing/brick_assembly.hpp"
#include "haptics/sharing/hand_balls.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/server_link.hpp"

namespace palpate {

using namespace sharing;

namespace {

/// Detects restarts of a session's simulation, as of water that a hand has driven too fast. Not thread-safe.
class RestartWatch {
 public:
  /// The participant must outlive it.
  RestartWatch(const Participant& participant, const Id& session)
      : session_(session),
        topic_(factsOf(participant, session_)),
        reader_(participant, topic_, keepingInstances(reliableQos(true), 1)) {}

  RestartWatch(const RestartWatch&) = delete;
  RestartWatch& operator=(const RestartWatch&) = delete;
  /// Number of restarts since the last call, and the reason of the last one; nothing if there was none. Restarts before
  /// the first facts received do not count. Reports at most twice a second.
  std::optional<Restarts> fresh() {
    constexpr double kApart_s = 0.5;
    reader_.take([&](const Facts& facts) {
      if (!isSame(facts.session, session_)) return;
      heard_ = {.count = facts.restarts, .why = printable(facts.why)};
      if (!told_) told_ = heard_.count;
    });
    if (!told_ || heard_.count == *told_ || (lastTold_ && lastTold_->elapsed_s() < kApart_s)) return std::nullopt;
    lastTold_.emplace();
    const std::uint32_t before = *told_;
    told_ = heard_.count;
    if (heard_.count < before) return std::nullopt;  // no palpate server sends that
    return Restarts{.count = heard_.count - before, .why = heard_.why};
  }

 private:
  Id session_;
  Topic<Facts> topic_;
  Reader<Facts> reader_;
  Restarts heard_;
  std::optional<std::uint32_t> told_;
  std::optional<Stopwatch> lastTold_;
};

constexpr std::size_t kRoom = 1 << 18;  // points known at once, twice what a server sends
constexpr double kHandPoll_s = 0.004;   // polling interval of the hands' positions
constexpr int kMaxSpoilt = 100;         // invalid samples before one step is complete
constexpr double kFirstTrip_ms = 100;   // until one is measured
constexpr double kMinSpeed_mm_s = 60;   // of a hand that may start to move
constexpr double kFastestOf_s = 5;      // how long the fastest transmission from the server counts

/// Converts the server's time to this machine's by the fastest recent transmission; what is felt lags by that time.
class FastestWay {
 public:
  double arrived(double now_s, double sent_s) {
    if (now_s - since_s_ > kFastestOf_s) {
      before_ = now_;
      now_.reset();
      since_s_ = now_s;
    }
    const double way = now_s - sent_s;
    now_ = std::min(now_.value_or(way), way);
    return sent_s + std::min(*now_, before_.value_or(*now_));
  }

 private:
  double since_s_ = 0;
  std::optional<double> now_, before_;
};

class FarLink final : public BrickCloud {
 public:
  explicit FarLink(const FarParts& parts)
      : parts_(parts),
        to_(*parts.session),
        source_(
            {.edge = parts.facts.edge, .points = kRoom, .moves = parts.facts.moves, .colored = parts.notice.colored}),
        link_(to_, parts.log, [this] { source_.giveUp(); }),
        assembly_(parts.facts.edge, kRoom),
        balls_(parts.facts.edge, kMinSpeed_mm_s / parts.notice.mm_per_unit),
        restarts_(std::in_place, to_.participant, to_.session) {
    assembly_.begin();
    thread_ =
        startThread([this](const std::stop_token& stop) { link_.run(stop, kHandPoll_s, nullptr, [this] { turn(); }); });
  }

  BrickSource& source() override { return source_; }
  bool moves() const override { return parts_.facts.moves; }
  const InformationAge& known() const override { return link_.known(); }
  bool isSculptable() const override { return parts_.notice.sculptable && !moves(); }

  FarCounts counts() const override {
    const std::scoped_lock hold(link_.lock());
    FarCounts counts = counts_;
    const BrickSource::Known known = source_.known();
    counts.bricks = known.bricks;
    counts.known = known.points;
    counts.sent = outbox_.sentStates();
    counts.resent = outbox_.resent();
    counts.delivered = outbox_.isEmpty() && known.allTaken;
    counts.silent_s = link_.silent_s();
    counts.longestSilent_s = link_.longestSilent_s();
    const LinkCounts link = link_.counts();
    counts.pings = link.pings;
    counts.answered = link.answered;
    counts.roundTrip_ms = link.roundTrip_ms;
    return counts;
  }

  std::vector<std::string> takeSaid() override { return link_.takeSaid(); }
  ServerFile* file() override { return &link_; }

  void check() const override {
    const std::scoped_lock hold(link_.lock());
    if (!link_.fault().empty()) throw NetworkError("{}", link_.fault());
  }

 private:
  void turn() {
    hear();
    if (link_.probe()) link_.heard();
    watchServer();
    hearRestarts();
    for (std::string& damaged : source_.takeSaid()) link_.add(std::move(damaged));
    send();
    if (const auto hands = source_.asked()) ask(*hands);
  }

  void hear() {
    bool gap = false;
    link_.points().take([&](const Points& sample) {
      if (gap) return;
      try {
        gap = !take(sample);
      } catch (const Error&) {
        // Damaged, or foreign: its content is requested again, unless nothing else is received.
        if (++spoilt_ > kMaxSpoilt) throw;
        gap = true;
      }
    });
    if (source_.takeRefused()) gap = true;
    if (gap) restart();
  }

  // False if an earlier sample is missing.
  bool take(const Points& sample) {
    const Heard heard = assembly_.hear(sample);
    if (heard != Heard::taken) return heard == Heard::old;
    ++counts_.samples;
    counts_.points += sample.points._length;
    link_.heard();
    if (auto update = assembly_.takeUpdate()) {
      update->true_s = way_.arrived(steadyNow_s(), update->true_s);
      update->settled = outbox_.taken(assembly_.acked());
      // While more bricks of an update are pending, the server acknowledges no strokes.
      if (!update->whole || std::exchange(lastAcked_, assembly_.acked()) != assembly_.acked()) progresses_ = true;
      const bool isChanged = source_.apply(std::move(*update));
      if (isChanged && !moves()) link_.changed();
      spoilt_ = 0;
      ++counts_.updates;
      counts_.mostKnown = std::max(counts_.mostKnown, source_.known().points);
    }
    return true;
  }

  // Sends the strokes of hands here to the server.
  void send() {
    made_.clear();
    source_.takeMade(made_);
    for (const MadeState& state : made_) outbox_.add(state);
    link_.send(outbox_, std::exchange(progresses_, false));
  }

  void restart() {
    assembly_.begin();
    outbox_.sendAgain();
    ++counts_.resumed;
  }

  // A new server of the same points is as good as the previous one.
  void watchServer() {
    const std::optional<SessionNotice> other = link_.isSilent() ? link_.successor() : std::nullopt;
    if (!other) return;
    if (other->checksum != parts_.notice.checksum || other->version != kVersion)
      return link_.fail(fmt::format("'{}' of {} has other points now; join it again", to_.name, other->host));
    if (outbox_.lastPiece() > 0)
      return link_.fail(
          fmt::format("'{}' of {} was restarted without its edits: those of this hand cannot be sent; join it again",
                      to_.name, other->host));
    link_.follow(other->session);
    restarts_.emplace(to_.participant, link_.server());
    way_ = {};  // its clock differs
    ++counts_.servers;
    restart();
  }

  void hearRestarts() {
    const std::optional<Restarts> fresh = restarts_->fresh();
    if (!fresh) return;
    counts_.restarts += fresh->count;
    link_.add(fmt::format("the simulation of '{}' has restarted at {}{}: it {}", to_.name, to_.host,
                          fresh->count > 1 ? fmt::format(", {} times", fresh->count) : std::string(), fresh->why));
  }

  void ask(const HandReaches& hands) {
    const double trip_s = link_.counts().roundTrip_ms.value_or(kFirstTrip_ms) * 1e-3;
    link_.points().ask(
        {.epoch = assembly_.epoch(), .taken = assembly_.taken(), .every = 0, .balls = balls_.around(hands, trip_s)});
  }

  const FarParts parts_;
  const JoinedSession& to_;
  BrickSource source_;

  ServerLink link_;  // its lock guards all members below
  BrickAssembly assembly_;
  HandBalls balls_;
  StrokeOutbox outbox_;
  std::vector<MadeState> made_;
  std::uint64_t lastAcked_ = 0;
  bool progresses_ = false;
  std::optional<RestartWatch> restarts_;
  FastestWay way_;
  FarCounts counts_;
  int spoilt_ = 0;       // invalid samples since the last complete step
  std::jthread thread_;  // destroyed first
};

}  // namespace

std::unique_ptr<BrickCloud> openFarCloud(const FarParts& parts) { return std::make_unique<FarLink>(parts); }

std::optional<HeardFacts> hearFacts(const JoinedSession& session, double timeout_s, const StopSign& stop) {
  const Topic<Facts> topic = factsOf(session.participant, session.session);
  const Reader<Facts> reader(session.participant, topic, keepingInstances(reliableQos(true), 1));
  ReaderWait wait(session.participant);
  wait.attach(reader);
  std::optional<HeardFacts> heard;
  bool isFileValid = true;
  for (const Stopwatch since; !heard && since.elapsed_s() < timeout_s;) {
    throwIfStopped(stop);
    wait.sleep(0.05);
    reader.take([&](const Facts& facts) {
      if (!isSame(facts.session, session.session)) return;
      const auto file = servedFileIn(facts);
      isFileValid = file.has_value();
      heard.emplace();
      heard->extent = {.bounds = {.min = DVec3(facts.low[0], facts.low[1], facts.low[2]),
                                  .max = DVec3(facts.high[0], facts.high[1], facts.high[2])},
                       .points = facts.points};
      heard->spacing = facts.spacing;
      heard->wideSpacing = facts.wide_spacing;
      heard->noise = facts.noise;
      heard->up = static_cast<UpAxis>(facts.up);
      heard->edge = facts.edge;
      heard->moves = facts.moves;
      heard->matter = facts.matter;
      heard->standing = facts.standing;
      heard->file = file.value_or(ServedFile{});
    });
  }
  if (!heard) return heard;
  constexpr double kLargest = 1e30;
  const auto isLength = [](double value) { return value >= 0 && value <= kLargest; };
  const auto isPlace = [](const DVec3& place) { return glm::length(place) <= kLargest; };
  if (!isFileValid || !(heard->edge > 0) || !isLength(heard->edge) || !isLength(heard->spacing) ||
      !isLength(heard->wideSpacing) || !isLength(heard->noise) || !isPlace(heard->extent.bounds.min) ||
      !isPlace(heard->extent.bounds.max) || heard->up > UpAxis::minusZ || heard->standing > heard->extent.points ||
      heard->extent.points >= std::uint64_t{1} << 32)
    throw NetworkError("'{}' of {} announces an invalid cloud", session.name, session.host);
  return heard;
}

}  // namespace palpate
