// Joins a session that another program serves, as a model shared with all other participants.
#pragma once

#include <string>

#include "haptics/session/model.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

struct Joining {
  std::string hand;       ///< name of this program's hands for the others; empty: that of the machine
  double timeout_s = 10;  ///< maximum wait for the session to be found, and for each next piece of it
  StopSign stop = {};     ///< cancels joining
};

/// Joins sessions as one more hand, whose strokes all participants receive, if the session can be sculpted.
SessionJoiner sessionJoiner(const Joining& how);
/// Fetches the present points of a session, for display only.
SessionJoiner pointsJoiner(const Joining& how);

}  // namespace palpate
