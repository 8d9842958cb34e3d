#pragma once

#include "engine/core/edit_batch.hpp"

namespace palpate {

/// Follows the edits of the points: a picture of them, the sharing of a session, or a recording.
class EditFollower {
 public:
  virtual ~EditFollower() = default;
  /// Applies the edits, in order. `batch`: all edits since the last call, if there is a history; a follower with its
  /// own connection to the back end needs none. Called on the thread of the session that takes edits, one call at a
  /// time.
  virtual void catchUp(const EditBatch& batch) = 0;
};

}  // namespace palpate
