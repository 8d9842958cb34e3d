#include "haptics/sharing/motion_thread.hpp"

#include <chrono>
#include <cstring>

namespace palpate::sharing {

namespace {

constexpr double kGone_s = 1;  // after which a hand that says nothing touches nothing
constexpr std::size_t kMostKnown = 256;

}  // namespace

MotionThread::MotionThread(const Parts& parts)
    : motion_(parts.motion),
      apart_s_(1 / parts.rate_Hz),
      room_(parts.cloud),
      reader_(parts.participant, parts.topics.hands, keepingInstances(bestEffortQos(), kMostShownHands)),
      session_(parts.session),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

std::shared_ptr<const CloudFrame> MotionThread::newest() {
  const std::scoped_lock hold(lock_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, nullptr);
}

void MotionThread::hearHands() {
  reader_.take([&](const palpate_sharing_Hand& hand) {
    if (!isSame(hand.session, session_)) return;
    const std::optional<HandPlace> place = room_.placeOf(hand);
    const Id client = idOf(hand.client);
    if (!place || (!hands_.contains(client) && hands_.size() >= kMostKnown)) return;
    Hand& known = hands_[client];
    known.since = {};
    std::memcpy(&known.seen.number, client.data(), sizeof known.seen.number);
    known.seen.name = printable(hand.name);
    known.seen.place = *place;
  });
  std::erase_if(hands_, [](const auto& one) { return one.second.since.elapsed_s() > kGone_s; });
}

void MotionThread::run(const std::stop_token& stop) {
  try {
    const Stopwatch since;
    for (double next_s = 0; !stop.stop_requested();) {
      const double now_s = since.elapsed_s();
      if (now_s < next_s) {
        std::this_thread::sleep_for(std::chrono::duration<double>(std::min(next_s - now_s, 0.02)));
        continue;
      }
      // What could not be made in time is left out.
      next_s = std::max(next_s + apart_s_, now_s);
      hearHands();
      std::vector<SeenHand> hands;
      for (const auto& [client, hand] : hands_) {
        hands.push_back(hand.seen);
        hands.back().age_s = hand.since.elapsed_s();
      }
      auto frame = std::make_shared<CloudFrame>();
      if (!motion_(now_s, hands, *frame)) continue;
      ++frames_;
      const std::scoped_lock hold(lock_);
      newest_ = std::move(frame);
    }
  } catch (...) {
    const std::scoped_lock hold(lock_);
    failure_ = std::current_exception();
  }
}

}  // namespace palpate::sharing
