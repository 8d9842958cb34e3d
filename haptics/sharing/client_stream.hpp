// The stream of points to one client: numbered samples, as far as the client keeps up.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// Forces on a client's hands, N: three for each.
using HandsForces = std::array<float, 3 * kMaxHands>;

/// A sample that is being written, with its sequences.
struct StreamSample {
  void clear();
  /// Valid until the next change of this.
  const Points& given();

  Points head{};
  std::vector<BrickPart> parts;
  std::vector<std::uint32_t> ids;
  std::vector<Point> points;
  std::vector<float> velocities;
  HandsForces forces{};
  std::vector<State> states;
};

/// Not thread-safe.
class ClientStream {
 public:
  ClientStream(const Participant& participant, const Topics& topics, const Id& session, const Id& client);

  enum class Asked {
    old,    ///< received out of order
    known,  ///< the stream continues
    fresh   ///< the stream begins again
  };
  Asked take(const Want& want);
  void heard() { heard_ = {}; }
  double silent_s() const { return heard_.elapsed_s(); }
  /// Whether the last step was acknowledged about as soon as the fastest one.
  bool keepsUp() const;
  bool isAcknowledged() const { return sample_ == taken_ && !holds_; }

  enum class Sent {
    nothing,  ///< nothing is due, or the client has to acknowledge samples first
    full,     ///< the link has no room
    sent
  };
  /// Sends the next sample of `feed`, whose next() fills it and returns false if none is due. `window`: maximum number
  /// of samples in flight.
  template <class Feed>
  Sent send(Feed& feed, std::uint64_t window) {
    if (!holds_) {
      if (!hasRoom(window)) return Sent::nothing;
      held_.clear();
      if (!feed.next(held_, *this)) return Sent::nothing;
      holds_ = true;
    }
    return write() ? Sent::sent : Sent::full;
  }
  bool hasRoom(std::uint64_t window) const { return sample_ - taken_ < std::min(window_, window); }
  /// Sends an empty sample if the client makes no progress: one that missed samples notices by its number.
  void probe();
  /// The last sample that was sent.
  const StreamSample& last() const { return held_; }

 private:
  void acknowledge(std::uint64_t taken);
  bool write();

  Id session_;
  Writer<Points> writer_;  // in the client's partition
  std::uint32_t number_ = 0, epoch_ = 0;
  std::uint64_t sample_ = 0, taken_ = 0, window_;
  StreamSample held_;
  bool holds_ = false;  // held_ is still to be written
  Points stated_{};     // head of the last sample, whose arrays are gone; a probe states the same
  struct Step {
    std::uint64_t sample = 0;
    Stopwatch since;
  };
  std::deque<Step> unacked_;  // last samples of steps, not acknowledged yet, oldest first
  double fastest_s_ = 1;      // shortest time from a sample to its acknowledgement
  Stopwatch heard_, progressed_;
};

}  // namespace palpate::sharing
