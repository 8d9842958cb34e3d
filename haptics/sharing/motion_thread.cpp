#include "haptics/sharing/motion_thread.hpp"

#include <chrono>

#include "engine/core/clock.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate::sharing {

namespace {

constexpr double kSilentHand_s = 1;  // a hand that is silent for this long touches nothing

}  // namespace

MotionThread::MotionThread(const Parts& parts)
    : motion_(parts.motion),
      apart_s_(1 / parts.rate_Hz),
      hands_(parts.participant, parts.topics, parts.cloud, kSilentHand_s),
      session_(parts.session),
      thread_(startThread([this](const std::stop_token& stop) { run(stop); })) {}

MotionThread::Moved MotionThread::newest() {
  const std::scoped_lock hold(lock_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, {});
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
      // Frames that are late are skipped.
      next_s = std::max(next_s + apart_s_, now_s);
      hands_.hear(session_);
      auto frame = std::make_shared<CloudFrame>();
      std::vector<SeenHand> hands = hands_.all();
      if (!motion_(now_s, hands, *frame)) continue;
      ++frames_;
      const std::scoped_lock hold(lock_);
      newest_ = {.frame = std::move(frame), .hands = std::move(hands)};
    }
  } catch (...) {
    const std::scoped_lock hold(lock_);
    failure_ = std::current_exception();
  }
}

}  // namespace palpate::sharing
