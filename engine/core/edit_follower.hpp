#pragma once

#include "engine/core/edit_batch.hpp"

namespace palpate {

/// Follows what is done to the points: a picture of them, those who share them, or whoever collects it.
class EditFollower {
 public:
  virtual ~EditFollower() = default;
  /// Takes in what has been done, in order. `batch`: all since the last call, where there is a journal; one that has a
  /// way of its own to the back end needs none. On the thread of a session that takes edits in, one call at a time.
  virtual void catchUp(const EditBatch& batch) = 0;
};

}  // namespace palpate
