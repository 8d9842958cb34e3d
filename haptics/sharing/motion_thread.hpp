// The points of a served cloud, moved against the clock.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "haptics/sharing/heard_hands.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate::sharing {

/// Moves them on a thread of its own from its beginning to its end, and hears where hands are meanwhile.
class MotionThread {
 public:
  struct Parts {
    ServedMotion motion;
    double rate_Hz = 60;
    const PointCloud& cloud;  ///< as it begins: about which hands are
    const Participant& participant;
    const Topics& topics;
    Id session;
  };
  explicit MotionThread(const Parts& parts);
  /// What has come since the last call; null: nothing. Throws what the motion has thrown.
  std::shared_ptr<const CloudFrame> newest();
  std::uint64_t frames() const { return frames_; }

 private:
  void run(const std::stop_token& stop);

  ServedMotion motion_;
  double apart_s_;
  HeardHands hands_;
  Id session_;
  std::mutex lock_;  // of the next two
  std::shared_ptr<const CloudFrame> newest_;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> frames_ = 0;
  std::jthread thread_;  // goes first
};

}  // namespace palpate::sharing
