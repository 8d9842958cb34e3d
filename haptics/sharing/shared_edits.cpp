#include "haptics/sharing/shared_edits.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_messages.hpp"
#include "haptics/sharing/link_probe.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/stroke_sender.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kEditPoll_s = 0.004;   // polling interval for offers; the hand's own edits wake the thread
constexpr double kServerSilence_s = 3;  // then the server is asked again
constexpr double kPieceTimeout_s = 5;   // then pieces that were sent and not taken are sent again
constexpr double kNear = 3;             // cells of the index around a proxy within which a change may be felt
constexpr double kSettled_s = 0.3;      // at rest, before the points are compared
constexpr int kMaxDiffered = 3;
constexpr int kMaxPieceRetries = 12;  // in a row without progress, while the server is heard

class SharedEdits final : public SharedFollower {
 public:
  explicit SharedEdits(const SharedParts& parts)
      : session_(*parts.session),
        keep_(parts.session),
        edits_(parts.edits),
        cell_(parts.cell),
        origin_(parts.cloud.origin),
        messages_(parts.log),
        exchange_(statesOf(parts.cloud), parts.edits.mostOffered()),
        strokes_(session_),
        resumes_(session_.participant, session_.topics.resumes, reliableQos(false)),
        probe_(session_),
        notices_(session_.participant, session_.topics),
        wakeUp_(session_.participant),
        wait_(std::in_place, session_.participant) {
    PALPATE_CHECK_LT(0U, parts.edits.mostOffered());
    std::uint8_t own[16];
    set(own, session_.client);
    results_ = Reader<Result>(session_.participant, session_.topics.results, reliableQos(false, partitionOf(own)));
    wait_->attach(results_);
    probe_.attach(*wait_);
    wait_->attach(wakeUp_);
    resume(exchange_.resume());
    thread_ = startThread([this](const std::stop_token& stop) { run(stop); });
  }

  void catchUp(const EditBatch& batch) override {
    const std::scoped_lock hold(lock_);
    if (!fault_.empty()) throw NetworkError("{}", fault_);
    exchange_.follow(batch);
    if (!batch.empty()) wakeUp_.call();
  }

  const InformationAge& known() const override { return known_; }
  void moved(const HandPlaces& hands) noexcept override { hands_.store(hands); }

  SharedCounts counts() const override {
    const std::scoped_lock hold(lock_);
    SharedCounts counts = counts_;
    counts.sent = exchange_.sentStates();
    counts.received = exchange_.receivedStates();
    counts.resent = exchange_.resent();
    counts.silent_s = lastHeard_.elapsed_s();
    counts.longestSilent_s = std::max(counts.longestSilent_s, counts.silent_s);
    counts.age_s = known_.age_s();
    counts.oldest_s = std::max(counts.oldest_s, counts.age_s);
    counts.force = known_.isTrue() ? known_.share() : 0;
    counts.link = probe_.counts();
    counts.delivered = exchange_.isDelivered();
    counts.idle = exchange_.isAtRest();
    counts.same = exchange_.isAtRest() && exchange_.isSame();
    counts.fault = fault_;
    return counts;
  }

  void askServer() override {
    const std::scoped_lock hold(lock_);
    if (fault_.empty()) ask(exchange_.ask());
  }

  std::vector<std::string> takeSaid() override { return messages_.take(); }

 private:
  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested() && fault_.empty()) {  // only this thread sets fault_
        wait_->sleep(kEditPoll_s);
        wakeUp_.take();
        {
          const std::scoped_lock hold(lock_);
          turn();
        }
        messages_.log();
      }
    } catch (const std::exception& error) {
      const std::scoped_lock hold(lock_);
      fail(error.what());
    }
    messages_.log();
    // From now on nothing that is received is kept.
    wait_.reset();
    results_ = {};
  }

  void turn() {
    hear();
    sayForce();
    watchServer();
    send();
    offer();
    counts_.inEffect += exchange_.isInEffect();
    judge();
    probe_.turn();
    if (const auto trip_ms = probe_.counts().roundTrip_ms) known_.setRoundTrip(*trip_ms * 1e-3);
  }

  void hear() {
    bool gap = false;
    results_.take([&](const Result& result) { gap = gap || hear(result) == EditExchange::Heard::gap; });
    if (gap) resume(exchange_.resume());
  }

  EditExchange::Heard hear(const Result& result) {
    const std::optional<Results> said = resultsOf(session_, result, exchange_.points().size(), states_);
    if (!said) return EditExchange::Heard::old;
    const EditExchange::Heard heard = exchange_.hear(*said);
    if (heard != EditExchange::Heard::taken) return heard;
    if (result.acked != lastAcked_) {
      lastTaken_ = {};
      stuck_ = 0;
    }
    lastAcked_ = result.acked;
    counts_.longestSilent_s = std::max(counts_.longestSilent_s, lastHeard_.elapsed_s());
    counts_.oldest_s = std::max(counts_.oldest_s, known_.age_s());
    lastHeard_ = {};
    known_.heard();
    return heard;
  }

  // Logs when silence starts or stops reducing the force.
  void sayForce() {
    const double share = known_.share(), silent_s = lastHeard_.elapsed_s();
    const Felt now = share >= 1 ? Felt::whole : share > 0 ? Felt::fading : Felt::gone;
    if (now == std::exchange(felt_, now)) return;
    if (now == Felt::whole)  // ForceGate waits for the hand to be outside
      messages_.add(
          fmt::format("messages from {} of {} arrive again: the force returns; where it was gone, once the hand has "
                      "left the surface",
                      session_.name, session_.host));
    if (now == Felt::fading)
      messages_.add(
          fmt::format("no message from {} of {} for {:.1f} s: the force fades; edits made here are kept for it",
                      session_.name, session_.host, silent_s));
    if (now == Felt::gone)
      messages_.add(fmt::format("no message from {} of {} for {:.1f} s: no force until the next message", session_.name,
                                session_.host, silent_s));
  }

  // Reports a server that takes nothing or has restarted as another session.
  void watchServer() {
    if (lastHeard_.elapsed_s() <= kServerSilence_s) {
      if (exchange_.isDelivered()) lastTaken_ = {};
      if (lastTaken_.elapsed_s() > kPieceTimeout_s) {
        if (++stuck_ > kMaxPieceRetries)
          return fail(fmt::format("'{}' of {} accepts no edits of this hand; save the cloud, and join it again",
                                  session_.name, session_.host));
        resume(exchange_.resume());
        lastTaken_ = {};
      }
      return;
    }
    if (lastResumed_.elapsed_s() > kServerSilence_s) resume(exchange_.resume());
    for (const SessionNotice& notice : notices_.known()) {
      if (notice.name != session_.name || notice.session == session_.session) continue;
      fail(
          fmt::format("'{}' of {} was restarted without its edits: those of this hand cannot be sent; save the cloud, "
                      "and join it again",
                      session_.name, session_.host));
      return;
    }
  }

  void resume(const Resume& asked) {
    ++counts_.resumed;
    ask(asked);
  }

  void ask(const Resume& asked) {
    resumes_.write(requestOf(session_, asked));
    lastResumed_ = {};
  }

  void send() { strokes_.send(exchange_.outbox(), session_.session); }

  void offer() {
    const std::span<const PointChange> changes = exchange_.nextOffer();
    if (!changes.empty())
      isOfferNear_ = std::ranges::any_of(changes, [&](const PointChange& each) { return isNear(each); });
    // Set before the change takes effect, and until it is known to have.
    if (isOfferNear_ && exchange_.isOffering()) known_.changed();
    if (!changes.empty() && edits_.offer(changes, exchange_.changesFollowed())) exchange_.offered();
  }

  // Whether a hand may feel that change where it touches.
  bool isNear(const PointChange& change) const {
    const std::optional<HandPlaces> hands = hands_.load();
    if (!hands) return true;
    const double reach = kNear * cell_;
    const auto isWithin = [&](const Vec3& position) {
      return std::any_of(hands->hands.begin(), hands->hands.begin() + hands->count, [&](const HandPlace& hand) {
        return glm::distance(origin_ + DVec3(position), hand.proxy) < reach;
      });
    };
    return isWithin(change.from.position) || isWithin(change.to.position);
  }

  // At rest the points are the same everywhere. If they are not, all edits ever made are requested again.
  void judge() {
    if (!exchange_.isAtRest() || exchange_.isSame()) {
      unequal_ = {};
      return;
    }
    if (unequal_.elapsed_s() < kSettled_s) return;
    if (++counts_.differed > kMaxDiffered)
      return fail(fmt::format("'{}' of {}: the points here are not those of the server", session_.name, session_.host));
    resume(exchange_.resumeAll());
    unequal_ = {};
  }

  void fail(const std::string& why) {
    if (!fault_.empty()) return;
    fault_ = why;
    known_.fail();
    messages_.add(why);
  }

  const JoinedSession& session_;
  const std::shared_ptr<const JoinedSession> keep_;
  EditStream& edits_;
  double cell_;
  DVec3 origin_;
  LinkMessages messages_;
  LatestValue<HandPlaces> hands_;

  mutable std::mutex lock_;  // guards all members below, unless stated otherwise
  EditExchange exchange_;
  StrokeSender strokes_;
  Writer<ResumeRequest> resumes_;
  Reader<Result> results_;
  LinkProbe probe_;
  SessionNotices notices_;
  WakeUp wakeUp_;
  std::optional<ReaderWait> wait_;  // used by the thread only
  SharedCounts counts_;
  std::string fault_;
  std::uint64_t lastAcked_ = 0;
  int stuck_ = 0;
  bool isOfferNear_ = false;
  std::vector<PointState> states_;
  Stopwatch lastHeard_, lastTaken_, lastResumed_, unequal_;
  enum class Felt { whole, fading, gone } felt_ = Felt::whole;
  InformationAge known_;
  std::jthread thread_;  // destroyed first
};

}  // namespace

std::unique_ptr<SharedFollower> shareEdits(const SharedParts& parts) { return std::make_unique<SharedEdits>(parts); }

}  // namespace palpate
