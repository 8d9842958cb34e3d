#include "haptics/sharing/far_link.hpp"

#include <algorithm>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/sharing/brick_assembly.hpp"
#include "haptics/sharing/hand_balls.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_messages.hpp"
#include "haptics/sharing/link_probe.hpp"
#include "haptics/sharing/restart_watch.hpp"
#include "haptics/sharing/stroke_sender.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr std::size_t kRoom = 1 << 18;  // points known at once, twice what a server sends
constexpr double kHandPoll_s = 0.004;   // polling interval of the hands' positions
constexpr double kAsk_s = 0.05;         // between two requests if nothing is new
constexpr double kNews_s = 0.005;       // and if something is
constexpr double kServerTimeout_s = 3;  // then another server of the same points is searched for
constexpr double kStrokeTimeout_s = 5;  // then unacknowledged strokes are sent again
constexpr int kMaxStrokeRetries = 12;   // maximum number of these in a row while the server sends messages
constexpr int kMaxSpoilt = 100;         // invalid samples before one step is complete
constexpr double kFirstTrip_s = 0.1;    // until one is measured
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
        messages_(parts.log),
        to_(*parts.session),
        server_(to_.session),
        source_(
            {.edge = parts.facts.edge, .points = kRoom, .moves = parts.facts.moves, .colored = parts.notice.colored}),
        assembly_(parts.facts.edge, kRoom),
        balls_(parts.facts.edge, kMinSpeed_mm_s / parts.notice.mm_per_unit),
        nears_(to_.participant, to_.topics.nears, bestEffortQos()),
        strokes_(to_),
        probe_(to_),
        notices_(to_.participant, to_.topics),
        restarts_(std::in_place, to_.participant, server_),
        wait_(std::in_place, to_.participant) {
    std::uint8_t own[16];
    set(own, to_.client);
    bricks_ = Reader<Bricks>(to_.participant, to_.topics.bricks, reliableQos(false, partitionOf(own)));
    wait_->attach(bricks_);
    assembly_.begin();
    counts_.resumed = 0;
    thread_ = startThread([this](const std::stop_token& stop) { run(stop); });
  }

  BrickSource& source() override { return source_; }
  bool moves() const override { return parts_.facts.moves; }
  const InformationAge& known() const override { return known_; }
  bool isSculptable() const override { return parts_.notice.sculptable && !moves(); }

  FarCounts counts() const override {
    const std::scoped_lock hold(lock_);
    FarCounts counts = counts_;
    const BrickSource::Known known = source_.known();
    counts.bricks = known.bricks;
    counts.known = known.points;
    counts.sent = outbox_.sentStates();
    counts.resent = outbox_.resent();
    counts.delivered = outbox_.isEmpty() && known.allTaken;
    counts.silent_s = lastHeard_.elapsed_s();
    counts.longestSilent_s = std::max(counts.longestSilent_s, counts.silent_s);
    const LinkCounts link = probe_.counts();
    counts.pings = link.pings;
    counts.answered = link.answered;
    counts.roundTrip_ms = link.roundTrip_ms;
    return counts;
  }

  std::vector<std::string> takeSaid() override { return messages_.take(); }

  void check() const override {
    const std::scoped_lock hold(lock_);
    if (!fault_.empty()) throw NetworkError("{}", fault_);
  }

 private:
  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested() && fault_.empty()) {  // only this thread sets fault_
        wait_->sleep(kHandPoll_s);
        {
          const std::scoped_lock hold(lock_);
          turn();
        }
        messages_.log();
      }
    } catch (const std::exception& error) {
      const std::scoped_lock hold(lock_);
      fail(fmt::format("'{}' of {}: {}", to_.name, to_.host, error.what()));
    }
    messages_.log();
    wait_.reset();
    bricks_ = {};
  }

  void turn() {
    hear();
    probe();
    watchServer();
    hearRestarts();
    send();
    if (const auto hands = source_.asked()) ask(*hands);
  }

  void hear() {
    bool gap = false;
    bricks_.take([&](const Bricks& sample) {
      if (gap || !isSame(sample.session, server_)) return;
      try {
        gap = !take(sample);
      } catch (const Error&) {
        // Damaged, or foreign: its content is requested again, unless nothing else is received.
        if (++spoilt_ > kMaxSpoilt) throw;
        gap = true;
      }
    });
    if (gap) restart();
  }

  // False if an earlier sample is missing.
  bool take(const Bricks& sample) {
    const BrickAssembly::Heard heard = assembly_.hear(sample);
    if (heard == BrickAssembly::Heard::old) return true;
    if (heard == BrickAssembly::Heard::gap) return false;
    ++counts_.samples;
    counts_.points += sample.points._length;
    isHeardNow();
    if (auto update = assembly_.takeUpdate()) {
      update->true_s = way_.arrived(steadyNow_s(), update->true_s);
      update->settled = outbox_.taken(assembly_.acked());
      // While more bricks of an update are pending, the server acknowledges no strokes.
      if (!update->whole || std::exchange(lastAcked_, assembly_.acked()) != assembly_.acked()) {
        progressed_ = {};
        stuck_ = 0;
      }
      const bool isChanged = source_.apply(std::move(*update));
      if (isChanged && !moves()) known_.changed();
      spoilt_ = 0;
      ++counts_.updates;
      counts_.mostKnown = std::max(counts_.mostKnown, source_.known().points);
    }
    return true;
  }

  // Sends the strokes of hands here to the server, and again if it does not acknowledge them.
  void send() {
    made_.clear();
    source_.takeMade(made_);
    for (const PointState& state : made_) outbox_.add(state);
    if (outbox_.isEmpty() || lastHeard_.elapsed_s() > kServerTimeout_s) progressed_ = {};
    if (progressed_.elapsed_s() > kStrokeTimeout_s) {
      if (++stuck_ > kMaxStrokeRetries)
        return fail(fmt::format("'{}' of {} accepts no edits of this hand; join it again", to_.name, to_.host));
      sendAgain();
      progressed_ = {};
    }
    strokes_.send(outbox_, server_);
  }

  void sendAgain() { outbox_.sendAgain(); }

  void restart() {
    assembly_.begin();
    sendAgain();
    ++counts_.resumed;
    isNew_ = true;
  }

  void isHeardNow() {
    counts_.longestSilent_s = std::max(counts_.longestSilent_s, lastHeard_.elapsed_s());
    lastHeard_ = {};
    known_.heard();
  }

  void probe() {
    if (!probe_.turn()) return;
    isHeardNow();
    trip_s_ = 1e-3 * probe_.counts().roundTrip_ms.value();
    known_.setRoundTrip(trip_s_);
  }

  // Logs silence and its end. A new server of the same points is as good as the previous one.
  void watchServer() {
    const double silent_s = lastHeard_.elapsed_s();
    const bool isWhole = known_.share() >= 1;
    if (isWhole && !std::exchange(wasWhole_, true))
      messages_.add(fmt::format("messages from {} of {} arrive again", to_.name, to_.host));
    if (!isWhole && std::exchange(wasWhole_, false))
      messages_.add(fmt::format("no message from {} of {} for {:.1f} s: the force fades until the next message",
                                to_.name, to_.host, silent_s));
    if (silent_s <= kServerTimeout_s) return;
    for (const SessionNotice& notice : notices_.known()) {
      if (notice.name != to_.name || notice.session == server_ || left_.contains(notice.session)) continue;
      if (notice.checksum != parts_.notice.checksum || notice.version != kVersion)
        return fail(fmt::format("'{}' of {} has other points now; join it again", to_.name, notice.host));
      if (outbox_.lastPiece() > 0)
        return fail(
            fmt::format("'{}' of {} was restarted without its edits: those of this hand cannot be sent; join it again",
                        to_.name, notice.host));
      left_.insert(server_);
      server_ = notice.session;
      probe_.follow(server_);
      restarts_.emplace(to_.participant, server_);
      way_ = {};  // its clock differs
      ++counts_.servers;
      return restart();
    }
  }

  void hearRestarts() {
    const std::optional<Restarts> fresh = restarts_->fresh();
    if (!fresh) return;
    counts_.restarts += fresh->count;
    messages_.add(fmt::format("the simulation of '{}' has restarted at {}{}: it {}", to_.name, to_.host,
                              fresh->count > 1 ? fmt::format(", {} times", fresh->count) : std::string(), fresh->why));
  }

  void ask(const HandReaches& hands) {
    std::vector<Ball> balls = balls_.around(hands, trip_s_);
    isNew_ = isNew_ || balls != asked_ || assembly_.taken() != told_;
    if (lastAsked_.elapsed_s() < (isNew_ ? kNews_s : kAsk_s)) return;
    isNew_ = false;
    lastAsked_ = {};
    asked_ = std::move(balls);
    told_ = assembly_.taken();
    std::vector<palpate_sharing_Ball> said;
    for (const Ball& ball : asked_)
      said.push_back({.center = {ball.center.x, ball.center.y, ball.center.z}, .radius = ball.radius});
    Near near{};
    set(near.session, server_);
    set(near.client, to_.client);
    put(near.host, host_);
    near.number = ++questions_;
    near.epoch = assembly_.epoch();
    near.taken = told_;
    give(near.balls, said);
    nears_.write(near);
  }

  void fail(const std::string& why) {
    if (!fault_.empty()) return;
    fault_ = why;
    known_.fail();
    source_.giveUp();
    messages_.add(why);
  }

  const FarParts parts_;
  LinkMessages messages_;
  const JoinedSession& to_;
  Id server_;
  std::set<Id> left_;  // previous sessions
  std::string host_ = ownHost();
  BrickSource source_;

  mutable std::mutex lock_;  // of all members below, unless stated otherwise
  BrickAssembly assembly_;
  HandBalls balls_;
  Writer<Near> nears_;
  StrokeSender strokes_;
  StrokeOutbox outbox_;
  std::vector<PointState> made_;
  Stopwatch progressed_;  // since strokes were last taken or none was pending
  int stuck_ = 0;
  std::uint64_t lastAcked_ = 0;
  LinkProbe probe_;
  Reader<Bricks> bricks_;
  SessionNotices notices_;
  std::optional<RestartWatch> restarts_;
  std::optional<ReaderWait> wait_;  // used by the thread only
  FastestWay way_;
  FarCounts counts_;
  std::string fault_;
  int spoilt_ = 0;  // invalid samples since the last complete step
  double trip_s_ = kFirstTrip_s;
  std::vector<Ball> asked_;
  std::uint64_t told_ = 0;
  bool isNew_ = true;
  std::uint32_t questions_ = 0;
  Stopwatch lastHeard_, lastAsked_;
  InformationAge known_;
  bool wasWhole_ = true;
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
