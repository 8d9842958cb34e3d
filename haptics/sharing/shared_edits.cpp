#include "haptics/sharing/shared_edits.hpp"

#include <algorithm>
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
#include "haptics/sharing/server_link.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kEditPoll_s = 0.004;  // polling interval for offers; the hand's own edits wake the thread
constexpr double kNear = 3;            // cells of the index around a proxy within which a change may be felt
constexpr double kSettled_s = 0.3;     // at rest, before the points are compared
constexpr int kMaxDiffered = 3;

class SharedEdits final : public SharedFollower {
 public:
  explicit SharedEdits(const SharedParts& parts)
      : session_(*parts.session),
        keep_(parts.session),
        edits_(parts.edits),
        cell_(parts.cell),
        origin_(parts.cloud.origin),
        wakeUp_(session_.participant),
        link_(session_, parts.log),
        exchange_(statesOf(parts.cloud), parts.edits.mostOffered()) {
    PALPATE_CHECK_LT(0U, parts.edits.mostOffered());
    resume(exchange_.resume());
    thread_ = startThread(
        [this](const std::stop_token& stop) { link_.run(stop, kEditPoll_s, &wakeUp_, [this] { turn(); }); });
  }

  void catchUp(const EditBatch& batch) override {
    const std::scoped_lock hold(link_.lock());
    if (!link_.fault().empty()) throw NetworkError("{}", link_.fault());
    exchange_.follow(batch);
    if (!batch.empty()) wakeUp_.call();
  }

  const InformationAge& known() const override { return link_.known(); }
  void moved(const HandPlaces& hands) noexcept override { hands_.store(hands); }

  SharedCounts counts() const override {
    const std::scoped_lock hold(link_.lock());
    SharedCounts counts = counts_;
    counts.sent = exchange_.sentStates();
    counts.received = exchange_.receivedStates();
    counts.resent = exchange_.resent();
    counts.silent_s = link_.silent_s();
    counts.longestSilent_s = link_.longestSilent_s();
    counts.age_s = known().age_s();
    counts.oldest_s = link_.oldest_s();
    counts.force = known().isTrue() ? known().share() : 0;
    counts.link = link_.counts();
    counts.delivered = exchange_.isDelivered();
    counts.idle = exchange_.isAtRest();
    counts.same = exchange_.isAtRest() && exchange_.isSame();
    counts.fault = link_.fault();
    return counts;
  }

  void askServer() override {
    const std::scoped_lock hold(link_.lock());
    if (link_.fault().empty()) asked_ = exchange_.ask();
  }

  std::vector<std::string> takeSaid() override { return link_.takeSaid(); }
  ServerFile* file() override { return &link_; }

 private:
  void turn() {
    hear();
    link_.probe();
    watchServer();
    link_.send(exchange_.outbox(), std::exchange(progresses_, false));
    ask();
    offer();
    counts_.inEffect += exchange_.isInEffect();
    judge();
  }

  void hear() {
    bool gap = false;
    link_.points().take([&](const Points& sample) { gap = gap || hear(sample) == Heard::gap; });
    if (gap) resume(exchange_.resume());
  }

  Heard hear(const Points& sample) {
    const std::optional<Results> said = resultsOf(sample, exchange_.points().size(), states_);
    if (!said) return Heard::old;
    const Heard heard = exchange_.hear(*said);
    if (heard != Heard::taken) return heard;
    if (std::exchange(lastAcked_, said->acked) != said->acked) progresses_ = true;
    link_.heard();
    return heard;
  }

  // Reports a server that has restarted as another session.
  void watchServer() {
    if (link_.isSilent() && link_.successor())
      link_.fail(
          fmt::format("'{}' of {} was restarted without its edits: those of this hand cannot be sent; save the cloud, "
                      "and join it again",
                      session_.name, session_.host));
  }

  void resume(const Resume& asked) {
    ++counts_.resumed;
    asked_ = asked;
  }

  // The cloud as served is here already.
  void ask() {
    link_.points().ask({.epoch = asked_.epoch,
                        .taken = exchange_.taken(),
                        .first = static_cast<std::uint32_t>(blocksOf(exchange_.points().size())),
                        .edits = true,
                        .upTo = asked_.upTo});
  }

  void offer() {
    const std::span<const PointChange> changes = exchange_.nextOffer();
    if (!changes.empty())
      isOfferNear_ = std::ranges::any_of(changes, [&](const PointChange& each) { return isNear(each); });
    // Set before the change takes effect, and until it is known to have.
    if (isOfferNear_ && exchange_.isOffering()) link_.changed();
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
      return link_.fail(
          fmt::format("'{}' of {}: the points here are not those of the server", session_.name, session_.host));
    resume(exchange_.resumeAll());
    unequal_ = {};
  }

  const JoinedSession& session_;
  const std::shared_ptr<const JoinedSession> keep_;
  EditStream& edits_;
  double cell_;
  DVec3 origin_;
  LatestValue<HandPlaces> hands_;
  WakeUp wakeUp_;

  ServerLink link_;  // its lock guards all members below
  EditExchange exchange_;
  Resume asked_;
  SharedCounts counts_;
  std::uint64_t lastAcked_ = 0;
  bool progresses_ = false;
  bool isOfferNear_ = false;
  std::vector<PointState> states_;
  Stopwatch unequal_;
  std::jthread thread_;  // destroyed first
};

}  // namespace

std::unique_ptr<SharedFollower> shareEdits(const SharedParts& parts) { return std::make_unique<SharedEdits>(parts); }

}  // namespace palpate
