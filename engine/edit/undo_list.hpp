#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

namespace palpate {

/// Changes that can be undone and redone, in order, within a budget of memory: the oldest are dropped first, and undone
/// ones are discarded when the next change begins. The list knows nothing of what is changed. `Change`: any type with a
/// function `bytesOf(change)`; a std::variant if there are several kinds, whose alternative tells them apart.
template <class Change>
class UndoList {
 public:
  /// With a budget of 0 nothing is kept, nor counted as dropped.
  explicit UndoList(std::uint64_t budget_bytes) : budget_(budget_bytes) {}

  bool keepsAny() const { return budget_ > 0; }
  /// A change begins: discards the undone ones.
  void begin() {
    for (const Change& change : undone_) bytes_ -= bytesOf(change);
    undone_.clear();
  }
  /// Drops the oldest changes until one of that many bytes fits; false if it is larger than the whole budget.
  bool makeRoom(std::uint64_t bytes) {
    for (; bytes_ + bytes > budget_ && !done_.empty(); ++dropped_) {
      bytes_ -= bytesOf(done_.front());
      done_.pop_front();
    }
    return bytes_ + bytes <= budget_;
  }
  /// The change that began has ended.
  void add(Change change) {
    bytes_ += bytesOf(change);
    done_.push_back(std::move(change));
  }
  /// It has ended, and was larger than the whole budget.
  void addTooLarge() {
    if (!keepsAny()) return;
    ++dropped_;
    ++tooLarge_;
  }

  /// Undoes the last change: calls `swap(change)`, which exchanges what the change has stored with what is present.
  /// False if there is no change to undo.
  template <class Swap>
  bool undo(const Swap& swap) {
    return move(done_, undone_, swap);
  }
  /// The same for the change undone last.
  template <class Swap>
  bool redo(const Swap& swap) {
    return move(undone_, done_, swap);
  }

  std::size_t undoCount() const { return done_.size(); }
  std::size_t redoCount() const { return undone_.size(); }
  /// Changes that can no longer be undone because of the budget; of these, those larger than the whole budget.
  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t tooLarge() const { return tooLarge_; }
  /// Memory of the changes.
  std::uint64_t bytes() const { return bytes_; }

 private:
  template <class From, class To, class Swap>
  bool move(From& from, To& to, const Swap& swap) {
    if (from.empty()) return false;
    to.push_back(std::move(from.back()));
    from.pop_back();
    bytes_ -= bytesOf(to.back());
    swap(to.back());
    bytes_ += bytesOf(to.back());
    return true;
  }

  std::uint64_t budget_;
  std::deque<Change> done_;
  std::vector<Change> undone_;
  std::uint64_t bytes_ = 0;  // of done_ and undone_
  std::uint64_t dropped_ = 0, tooLarge_ = 0;
};

}  // namespace palpate
