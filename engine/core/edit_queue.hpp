#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "engine/core/edit_batch.hpp"
#include "engine/core/priority_mutex.hpp"

namespace palpate {

/// Passes edits made on the CPU to one reader. The reader holds the lock only while it swaps two vectors. Edits are
/// kept only after keep() was called.
class EditQueue {
 public:
  void keep() {
    const std::scoped_lock hold(lock_);
    for (EditBatch* batch : {&pending_, &taken_}) batch->marks.reserve(kMarksWithoutAllocation);
    kept_ = true;
  }

  /// Appends state(0) to state(count - 1) and, if given, the mark that ends them; a reader never sees the states
  /// without the mark.
  template <class State>
  void append(std::size_t count, State&& state, std::optional<EditMark::Kind> end = std::nullopt) {
    const std::scoped_lock hold(lock_);
    if (!kept_) return;
    for (std::size_t i = 0; i < count; ++i) pending_.points.push_back(state(i));
    if (end) pending_.marks.push_back({pending_.points.size(), *end});
  }
  /// Appends a mark after all states so far.
  void mark(EditMark::Kind kind) {
    append(
        0, [](std::size_t) { return PointState(); }, kind);
  }

  /// Appends to `batch` everything since the last call. For one thread.
  void take(EditBatch& batch) {
    {
      const std::scoped_lock hold(lock_);
      std::swap(pending_, taken_);
    }
    const std::size_t before = batch.points.size();
    batch.points.insert(batch.points.end(), taken_.points.begin(), taken_.points.end());
    for (const EditMark& mark : taken_.marks) batch.marks.push_back({before + mark.at, mark.kind});
    taken_.clear();
  }

 private:
  static constexpr std::size_t kMarksWithoutAllocation = 1024;  // the thread that answers poses appends marks

  PriorityMutex lock_;
  EditBatch pending_;
  bool kept_ = false;
  EditBatch taken_;  // of the reader; its capacity returns at the next swap
};

}  // namespace palpate
