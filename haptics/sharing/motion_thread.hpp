// Moves the points of a served cloud in real time.
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

/// Moves them on its own thread during its lifetime, with the hands received meanwhile.
class MotionThread {
 public:
  struct Parts {
    ServedMotion motion;
    double rate_Hz = 60;
    const PointCloud& cloud;  ///< at the start; the hands are around it
    const Participant& participant;
    const Topics& topics;
    Id session;
  };
  explicit MotionThread(const Parts& parts);
  struct Moved {
    std::shared_ptr<const CloudFrame> frame;  ///< null: none since the last call
    std::vector<SeenHand> hands;              ///< with the forces on them
  };
  /// Newest frame since the last call. Rethrows what the motion has thrown.
  Moved newest();
  std::uint64_t frames() const { return frames_; }

 private:
  void run(const std::stop_token& stop);

  ServedMotion motion_;
  double apart_s_;
  HeardHands hands_;
  Id session_;
  std::mutex lock_;  // guards the next two
  Moved newest_;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> frames_ = 0;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate::sharing
