#pragma once

#include <mutex>

#include "engine/core/edit_batch.hpp"

namespace palpate {

/// Keeps of each stretch between marks the last state of each point. Says how many states went.
std::uint64_t mergeEdits(EditBatch& edits);
/// Adds `more` behind `edits`.
void append(EditBatch& edits, const EditBatch& more);

/// Edits that wait to be written, from one thread to another. Where too many wait, only the last state of each point in
/// each stroke is kept of them.
class PendingEdits {
 public:
  void add(const EditBatch& edits);
  /// States that wait.
  std::size_t size() const;
  /// Takes all that waits into `edits`, which is empty. Returns how many states had given way to later ones.
  std::uint64_t take(EditBatch& edits);

 private:
  static constexpr std::size_t kMaxStates = 1 << 20;

  mutable std::mutex lock_;
  EditBatch edits_;
  std::uint64_t merged_ = 0;
  std::size_t least_ = 0;  // what merging left
};

}  // namespace palpate
