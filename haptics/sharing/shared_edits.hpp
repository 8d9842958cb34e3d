// Shares the edits of a joined cloud: this hand's are sent to the server, and those of others are received.
#pragma once

#include <memory>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/edit_stream.hpp"
#include "engine/core/log.hpp"
#include "haptics/shared_follower.hpp"

namespace palpate {

/// Session that a cloud was joined from (joinCloud()).
class JoinedSession;

struct SharedParts {
  std::shared_ptr<const JoinedSession> session;
  const PointCloud& cloud;  ///< as joined
  EditStream& edits;        ///< of `cloud`, without resampling
  double cell = 0;          ///< edge of a cell of its index, model units
  Log* log = nullptr;       ///< logs silence and its end
};

/// Starts exchanging strokes on a thread of its own. Permanent failures there are thrown by catchUp(), as NetworkError.
/// All that `parts` refers to must outlive it.
std::unique_ptr<SharedFollower> shareEdits(const SharedParts& parts);

}  // namespace palpate
