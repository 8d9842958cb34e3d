#pragma once

#include <mutex>

#include "engine/core/edit_batch.hpp"

namespace palpate {

/// Keeps only the last state of each point between two marks. Returns the number of dropped states.
std::uint64_t mergeEdits(EditBatch& edits);
/// Appends `more` to `edits`, without what its new points took from their parents.
void append(EditBatch& edits, const EditBatch& more);

/// Edits that wait to be written, from one thread to another. If too many wait, only the last state of each point in
/// each stroke is kept.
class PendingEdits {
 public:
  void add(const EditBatch& edits);
  /// Number of waiting states.
  std::size_t size() const;
  /// Moves all waiting edits to `edits`, which must be empty. Returns the number of superseded states.
  std::uint64_t take(EditBatch& edits);

 private:
  static constexpr std::size_t kMaxStates = 1 << 20;

  mutable std::mutex lock_;
  EditBatch edits_;
  std::uint64_t merged_ = 0;
  std::size_t least_ = 0;  // size after the last merge
};

}  // namespace palpate
