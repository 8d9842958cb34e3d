#pragma once

#include "haptics/servo_loop.hpp"
#include "haptics/shared_follower.hpp"

namespace palpate {

/// Publishes the positions of the hands at each tick: to the presence, which shows them to others, and to the shared
/// follower, which applies the changes of others gently where a hand touches.
class HandPublisher final : public TickRecorder {
 public:
  /// Either pointer may be null. `hands`: their number. `sculpts`: the first one has a brush.
  HandPublisher(SharedFollower* shared, SharedPresence* presence, std::size_t hands, bool sculpts)
      : shared_(shared), presence_(presence), sculpts_(sculpts) {
    hands_.count = static_cast<std::uint32_t>(hands);
  }
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override { hands_.hands[hand] = placeOf(row); }
  void ticked(const TraceRow& row, const DeviceState&) noexcept override {
    hands_.hands[0] = placeOf(row);
    hands_.hands[0].sculpts = sculpts_;
    publish(hands_);
  }
  void setSculpts(bool sculpts) noexcept { sculpts_ = sculpts; }
  void publish(const HandPlaces& hands) noexcept {
    if (shared_) shared_->moved(hands);
    if (presence_) presence_->moved(hands);
  }

 private:
  static HandPlace placeOf(const TraceRow& row) {
    return {.position = row.hip, .proxy = row.proxy, .touching = row.contact};
  }

  SharedFollower* shared_;
  SharedPresence* presence_;
  bool sculpts_;
  HandPlaces hands_;
};

}  // namespace palpate
