// One hand's part in a cloud that several feel and sculpt, each on its own machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/edit_follower.hpp"
#include "haptics/information_age.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

/// What pings say of the way to the server and back.
struct LinkCounts {
  std::uint64_t pings = 0, answered = 0;
  std::uint64_t lost = 0;              ///< not answered within two seconds
  std::optional<double> roundTrip_ms;  ///< the median of the last ones
  std::optional<double> lost_percent;  ///< of the last ones, there or back
};

/// How it goes with the others.
struct SharedCounts {
  std::uint64_t sent = 0;      ///< states of points that this hand has made
  std::uint64_t received = 0;  ///< that others have made, as they took effect here
  std::uint64_t resent = 0;    ///< pieces of strokes that went more than once
  std::uint64_t copied = 0;    ///< of what the server has said, whose best-effort copy came first
  std::uint64_t resumed = 0;   ///< times that what was missing was asked for, the first included
  std::uint64_t differed = 0;  ///< times that the points at rest were others than the server's, and were all asked for
  std::uint64_t inEffect = 0;  ///< times that all that others had done, as far as it was heard, was in effect here
  double silent_s = 0;         ///< since the server was heard last
  double longestSilent_s = 0;
  double age_s = 0;     ///< of what is known: since what was heard last was said
  double oldest_s = 0;  ///< that this has been
  double force = 1;     ///< the share of a force that this bears (InformationAge)
  LinkCounts link;
  bool delivered = false;  ///< all that this hand has done has been taken
  bool atRest = false;     ///< and all that others have done is in effect here
  bool same = false;       ///< at rest: the points are the server's, bit by bit
  std::string fault;       ///< why this hand's part has ended for good; empty: it goes on
};

/// What one hand does goes to the others as it is taken in (catchUp()), and what they do is offered to what answers it.
class SharedFollower : public EditFollower {
 public:
  /// How old what is felt is, and whether the others change it where this hand is.
  virtual const InformationAge& known() const = 0;
  virtual SharedCounts counts() const = 0;
  /// Asks the server how far it is. From now on counts().atRest and counts().same are false until the server has
  /// answered, and what it had taken by then is in effect here.
  virtual void askServer() = 0;
  /// Where the hands are that feel what the others change. For the thread that answers them: waits for nobody.
  virtual void moved(const HandPlaces& hands) noexcept = 0;
  /// What the log was told since the last call, the first few of it: for who shows it elsewhere, too. For any thread.
  virtual std::vector<std::string> takeSaid() = 0;
};

}  // namespace palpate
