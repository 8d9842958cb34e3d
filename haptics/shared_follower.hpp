// One hand's part in a cloud that several users feel and sculpt, each on their own machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/edit_follower.hpp"
#include "haptics/information_age.hpp"
#include "haptics/server_file.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

/// Statistics of pings to the server and back.
struct LinkCounts {
  std::uint64_t pings = 0, answered = 0;
  std::uint64_t lost = 0;              ///< not answered within two seconds
  std::optional<double> roundTrip_ms;  ///< median of the last ones
  std::optional<double> lost_percent;  ///< of the last ones, there or back
};

/// State of the exchange with the others.
struct SharedCounts {
  std::uint64_t sent = 0;      ///< states of points that this hand has changed
  std::uint64_t received = 0;  ///< of others, counted when they take effect here
  std::uint64_t resent = 0;    ///< pieces of strokes sent more than once
  std::uint64_t resumed = 0;   ///< requests for what was missing, the first included
  std::uint64_t differed = 0;  ///< times that the points at rest differed from the server's and were requested again
  std::uint64_t inEffect = 0;  ///< times that all known edits of others were in effect here
  double silent_s = 0;         ///< since the server was last heard
  double longestSilent_s = 0;
  double age_s = 0;     ///< of the information: since the last received message was sent
  double oldest_s = 0;  ///< maximum of it
  double force = 1;     ///< share of a force that this permits (InformationAge)
  LinkCounts link;
  bool delivered = false;  ///< the server has taken all edits of this hand
  bool idle = false;       ///< and all edits of others are in effect here
  bool same = false;       ///< at rest: the points equal the server's, bit by bit
  std::string fault;       ///< why this hand's part has ended for good; empty: it continues
};

/// Sends one hand's edits to the others as they are taken in (catchUp()), and offers their edits to its back end.
class SharedFollower : public EditFollower {
 public:
  /// Age of the information, and whether others are changing the surface at this hand.
  virtual const InformationAge& known() const = 0;
  virtual SharedCounts counts() const = 0;
  /// Asks the server how far it is. From now on counts().idle and counts().same are false until the server has
  /// answered, and all that it had taken by then is in effect here.
  virtual void askServer() = 0;
  /// Positions of the hands that feel the changes of others. For the thread that answers them: never blocks.
  virtual void moved(const HandPlaces& hands) noexcept = 0;
  /// Log messages since the last call, the first few of them, to be shown elsewhere, too. Thread-safe.
  virtual std::vector<std::string> takeSaid() = 0;
  /// The file of the server; null: unknown.
  virtual ServerFile* file() { return nullptr; }
};

}  // namespace palpate
