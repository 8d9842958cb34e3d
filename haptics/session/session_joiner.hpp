// The way from a session that another program serves to a model that is shared with whoever has joined it, too.
#pragma once

#include <string>

#include "haptics/session/model.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

struct Joining {
  std::string hand;        ///< what the others see this program's hands called; empty: as the machine
  double patience_s = 10;  ///< for the session to be found, and for each next piece of it
  StopSign stop = {};      ///< ends it
};

/// Joins sessions as one more hand: its strokes are everybody's, where the session is sculpted at all.
SessionJoiner sessionJoiner(const Joining& how);
/// Fetches the points of a session as they are, to look at them.
SessionJoiner pointsJoiner(const Joining& how);

}  // namespace palpate
