#include "haptics/sharing/shared_edits.hpp"

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/core/statistics.hpp"
#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kLook_s = 0.004;      // how often what this hand has done, and what can be offered, is looked for
constexpr double kSilent_s = 3;        // after which the server is asked again, and what is felt may not be true any more
constexpr double kStuck_s = 5;         // the same for pieces that were sent and not taken
constexpr double kHand_s = 1.0 / 60;   // between two places of a hand
constexpr double kHandSeen_s = 2;      // after which a hand that says nothing is gone
constexpr double kPing_s = 0.5;
constexpr std::size_t kTrips = 32;     // of which the round trip is the median
constexpr std::size_t kMostHands = 256;
constexpr double kSettled_s = 0.3;     // at rest, before it is judged whether the points are the same
constexpr int kMostDiffered = 3;
constexpr int kMostStuck = 12;         // times in a row that nothing was taken, though the server is heard

class SharedEdits final : public SharedFollower {
 public:
  explicit SharedEdits(const SharedParts& parts)
      : session_(*parts.session),
        keep_(parts.session),
        backend_(parts.backend),
        origin_(parts.cloud.origin),
        hand_(parts.hand.empty() ? ownHost() : parts.hand),
        log_(parts.log),
        exchange_(statesOf(parts.cloud), parts.backend.mostOffered()),
        strokes_(session_.participant, session_.topics.strokes, reliableQos(false)),
        resumes_(session_.participant, session_.topics.resumes, reliableQos(false)),
        pings_(session_.participant, session_.topics.pings, bestEffortQos()),
        handWriter_(session_.participant, session_.topics.hands, bestEffortQos()),
        echoes_(session_.participant, session_.topics.echoes, bestEffortQos()),
        handReader_(session_.participant, session_.topics.hands, bestEffortQos()),
        notices_(session_.participant, session_.topics),
        wait_(std::in_place, session_.participant) {
    PALPATE_CHECK_LT(0U, parts.backend.mostOffered());
    std::uint8_t own[16];
    set(own, session_.client);
    results_ = Reader<Result>(session_.participant, session_.topics.results, reliableQos(false, partitionOf(own)));
    wait_->attach(results_);
    resume(exchange_.resume());
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  void catchUp(const EditBatch& batch) override {
    const std::scoped_lock hold(lock_);
    if (!fault_.empty()) throw NetworkError("{}", fault_);
    exchange_.follow(batch);
  }

  const std::atomic<bool>& isHeard() const override { return heard_; }
  void moved(const HandPlace& place) noexcept override { place_.store(place); }

  SharedCounts counts() const override {
    const std::scoped_lock hold(lock_);
    SharedCounts counts = counts_;
    counts.sent = exchange_.sentStates();
    counts.received = exchange_.receivedStates();
    counts.resent = exchange_.resent();
    counts.silent_s = lastHeard_.elapsed_s();
    counts.longestSilent_s = std::max(counts.longestSilent_s, counts.silent_s);
    if (!trips_ms_.empty()) counts.roundTrip_ms = summarize({trips_ms_.begin(), trips_ms_.end()}).p50;
    counts.delivered = exchange_.isDelivered();
    counts.atRest = exchange_.isAtRest();
    counts.same = exchange_.isAtRest() && exchange_.isSame();
    counts.fault = fault_;
    return counts;
  }

  std::vector<SeenHand> others() const override {
    const std::scoped_lock hold(lock_);
    std::vector<SeenHand> seen;
    for (const auto& [client, other] : others_) {
      seen.push_back(other.seen);
      seen.back().age_s = other.since.elapsed_s();
      if (seen.back().age_s > kHandSeen_s) seen.pop_back();
    }
    return seen;
  }

 private:
  struct Other {
    SeenHand seen;
    Stopwatch since;
    std::uint64_t last = 0;
  };

  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested() && fault_.empty()) {  // which this thread alone sets
        wait_->sleep(kLook_s);
        {
          const std::scoped_lock hold(lock_);
          turn();
        }
        tell();
      }
    } catch (const std::exception& error) {
      const std::scoped_lock hold(lock_);
      fail(error.what());
    }
    tell();
    // What comes from now on is not kept for anybody.
    wait_.reset();
    results_ = {};
  }

  void turn() {
    hear();
    watchServer();
    send();
    offer();
    counts_.inEffect += exchange_.isInEffect();
    judge();
    ping();
    showHand();
  }

  void hear() {
    bool gap = false;
    results_.take([&](const Result& result) {
      if (!isSame(result.session, session_.session) || gap) return;
      const EditExchange::Heard heard =
          exchange_.hear(resultsOf(session_, result, exchange_.points().size(), states_));
      if (heard == EditExchange::Heard::old) return;
      gap = heard == EditExchange::Heard::gap;
      if (result.acked != lastAcked_) {
        lastTaken_ = {};
        stuck_ = 0;
      }
      lastAcked_ = result.acked;
      counts_.longestSilent_s = std::max(counts_.longestSilent_s, lastHeard_.elapsed_s());
      lastHeard_ = {};
    });
    if (gap) resume(exchange_.resume());
  }

  // Silence is said, and its end; so is a server that has begun anew.
  void watchServer() {
    const double silent_s = lastHeard_.elapsed_s();
    if (silent_s <= kSilent_s) {
      if (!heard_.exchange(true)) say(fmt::format("{} of {} is heard again", session_.name, session_.host));
      if (exchange_.isDelivered()) lastTaken_ = {};
      if (lastTaken_.elapsed_s() > kStuck_s) {
        if (++stuck_ > kMostStuck)
          return fail(fmt::format("'{}' of {} takes nothing of what this hand does; save what is here, and join it again",
                                  session_.name, session_.host));
        resume(exchange_.resume());
        lastTaken_ = {};
      }
      return;
    }
    if (heard_.exchange(false))
      say(fmt::format("{} of {} has not been heard for {:.0f} s: the force fades until it is; what is done here is kept for it",
                      session_.name, session_.host, silent_s));
    if (lastResumed_.elapsed_s() > kSilent_s) resume(exchange_.resume());
    for (const SessionNotice& notice : notices_.known()) {
      if (notice.name != session_.name || notice.session == session_.session) continue;
      fail(fmt::format("'{}' of {} was served anew, without what had been done to it: this hand's part of it has nowhere to "
                       "go; save what is here, and join it again",
                       session_.name, session_.host));
      return;
    }
  }

  void resume(const Resume& asked) {
    resumes_.write(requestOf(session_, asked));
    lastResumed_ = {};
    ++counts_.resumed;
  }

  void send() {
    while (const StrokePiece* piece = exchange_.nextPiece(kStates)) {
      Stroke stroke{};
      set(stroke.session, session_.session);
      set(stroke.client, session_.client);
      stroke.number = piece->number;
      sent_.clear();
      for (const PointState& point : piece->states) sent_.push_back(stateOf(point));
      stroke.states._buffer = sent_.data();
      stroke.states._length = stroke.states._maximum = static_cast<std::uint32_t>(sent_.size());
      if (strokes_.write(stroke)) continue;
      exchange_.notSent();
      return;
    }
  }

  void offer() {
    const std::span<const PointChange> changes = exchange_.nextOffer();
    if (!changes.empty() && backend_.offer(changes, exchange_.changesFollowed())) exchange_.offered();
  }

  // At rest the points are everywhere the same. Where they are not, all that was ever done is asked for again.
  void judge() {
    if (!exchange_.isAtRest() || exchange_.isSame()) {
      unequal_ = {};
      return;
    }
    if (unequal_.elapsed_s() < kSettled_s) return;
    if (++counts_.differed > kMostDiffered)
      return fail(fmt::format("'{}' of {}: the points here are not those of the server", session_.name, session_.host));
    resume(exchange_.resumeAll());
    unequal_ = {};
  }

  void ping() {
    echoes_.take([&](const Ping& echo) {
      if (!isSame(echo.session, session_.session) || !isSame(echo.client, session_.client)) return;
      const double trip_us = since_.elapsed_us() - echo.sent_us;
      if (echo.number > counts_.pings || !(trip_us >= 0)) return;
      ++counts_.answered;
      trips_ms_.push_back(trip_us * 1e-3);
      if (trips_ms_.size() > kTrips) trips_ms_.pop_front();
    });
    if (lastPing_.elapsed_s() < kPing_s) return;
    lastPing_ = {};
    Ping ping{};
    set(ping.session, session_.session);
    set(ping.client, session_.client);
    ping.number = static_cast<std::uint32_t>(++counts_.pings);
    ping.sent_us = since_.elapsed_us();
    pings_.write(ping);
  }

  void showHand() {
    handReader_.take([&](const Hand& hand) {
      if (!isSame(hand.session, session_.session) || isSame(hand.client, session_.client)) return;
      const DVec3 position(hand.position[0], hand.position[1], hand.position[2]);
      const DVec3 proxy(hand.proxy[0], hand.proxy[1], hand.proxy[2]);
      if (!isFinite(position) || !isFinite(proxy)) return;
      const Id client = idOf(hand.client);
      if (!others_.contains(client) && others_.size() >= kMostHands) return;
      Other& other = others_[client];
      if (other.last >= hand.number && other.since.elapsed_s() < kHandSeen_s) return;  // overtaken
      std::memcpy(&other.seen.number, client.data(), sizeof other.seen.number);
      other.last = hand.number;
      other.since = {};
      other.seen.name = printable(hand.name);
      other.seen.place = {.position = position, .proxy = proxy, .touching = hand.touching, .sculpts = hand.sculpts};
    });
    std::erase_if(others_, [](const auto& one) { return one.second.since.elapsed_s() > 5 * kHandSeen_s; });
    if (lastShown_.elapsed_s() < kHand_s) return;
    const std::optional<HandPlace> place = place_.load();
    if (!place) return;
    lastShown_ = {};
    Hand hand{};
    set(hand.session, session_.session);
    set(hand.client, session_.client);
    put(hand.name, hand_);
    for (int axis = 0; axis < 3; ++axis) {
      hand.position[axis] = place->position[axis];
      hand.proxy[axis] = place->proxy[axis];
    }
    hand.orientation[3] = 1;
    hand.touching = place->touching;
    hand.sculpts = place->sculpts;
    hand.number = static_cast<std::uint32_t>(++handsShown_);
    handWriter_.write(hand);
  }

  void fail(const std::string& why) {
    if (!fault_.empty()) return;
    fault_ = why;
    heard_ = false;
    say(why);
  }

  void say(std::string what) { said_.push_back(std::move(what)); }

  // Without the lock, which who answers the hand may wait for: who listens takes as long as it likes. It may also end what
  // says it (LogListener), which would be this hand's part in the session.
  void tell() {
    std::vector<std::string> said;
    {
      const std::scoped_lock hold(lock_);
      said.swap(said_);
    }
    if (!log_) return;
    try {
      for (const std::string& what : said) log_->say("{}", what);
    } catch (...) {
    }
  }

  const JoinedSession& session_;
  const std::shared_ptr<const JoinedSession> keep_;
  TouchBackend& backend_;
  DVec3 origin_;
  std::string hand_;
  Log* log_;

  mutable std::mutex lock_;  // of all that follows but what says otherwise
  EditExchange exchange_;
  Writer<Stroke> strokes_;
  Writer<ResumeRequest> resumes_;
  Writer<Ping> pings_;
  Writer<Hand> handWriter_;
  Reader<Result> results_;
  Reader<Ping> echoes_;
  Reader<Hand> handReader_;
  SessionNotices notices_;
  std::optional<ReaderWait> wait_;  // the thread's alone
  SharedCounts counts_;
  std::string fault_;
  std::vector<std::string> said_;
  std::map<Id, Other> others_;
  std::uint64_t handsShown_ = 0, lastAcked_ = 0;
  int stuck_ = 0;
  std::deque<double> trips_ms_;
  std::vector<PointState> states_;
  std::vector<State> sent_;
  Stopwatch since_, lastHeard_, lastTaken_, lastResumed_, lastPing_, lastShown_, unequal_;
  std::atomic<bool> heard_ = true;
  LatestValue<HandPlace> place_;
  std::jthread thread_;  // goes first
};

}  // namespace

std::unique_ptr<SharedFollower> shareEdits(const SharedParts& parts) { return std::make_unique<SharedEdits>(parts); }

}  // namespace palpate
