#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <utility>

#include "engine/edit/kept_changes.hpp"

namespace palpate {

/// Memory and disk of changes that can be undone.
struct UndoBudget {
  std::uint64_t bytes = 0;       ///< in memory; with 0 nothing is kept, nor counted as dropped
  std::filesystem::path folder;  ///< for the changes for which there is no memory; empty: they are dropped
  std::uint64_t disk_bytes = 0;
};

/// Changes that can be undone and redone, in order, within a budget: those that are farthest from the present go to the
/// disk, and are dropped once that is full; undone ones are discarded when the next change begins. The list knows
/// nothing of what is changed. `Change`: any type with functions `bytesOf(change)`, `pack(change)`, which gives its
/// bytes, and `unpack(bytes, change)`; a std::variant if there are several kinds, whose alternative tells them apart.
template <class Change>
class UndoList {
 public:
  explicit UndoList(const UndoBudget& budget) : budget_(budget.bytes), done_(budget), undone_(budget) {}

  bool keepsAny() const { return budget_ > 0; }
  /// A change begins: discards the undone ones.
  void begin() {
    for (const Change& change : undone_.near) bytes_ -= bytesOf(change);
    undone_.clear();
  }
  /// Frees memory of the oldest changes until one of that many bytes fits; false if it is larger than the whole budget.
  bool makeRoom(std::uint64_t bytes) {
    while (bytes_ + bytes > budget_ && !done_.near.empty()) dropped_ += putAway(done_);
    return bytes_ + bytes <= budget_;
  }
  /// The change that began has ended.
  void add(Change change) {
    bytes_ += bytesOf(change);
    done_.near.push_back(std::move(change));
  }
  /// More of the change made last, which is in memory: calls `exchange(change)`, which makes that, and adds to `change`
  /// what undoes it. If it throws, it has left `change` as it was.
  template <class Exchange>
  void extend(const Exchange& exchange) {
    const std::uint64_t before = bytesOf(done_.near.back());
    exchange(done_.near.back());
    bytes_ -= before;
    keepLast();
  }
  /// A whole change: calls `exchange(change)`, which makes it and leaves in `change` what undoes it. Memory is taken
  /// before that: if it throws, the list is unchanged.
  template <class Exchange>
  void make(Change change, const Exchange& exchange) {
    if (!keepsAny()) return exchange(change);
    done_.near.push_back(std::move(change));
    try {
      exchange(done_.near.back());
    } catch (...) {
      done_.near.pop_back();
      throw;
    }
    keepLast();
  }
  /// It has ended, and was larger than the whole budget.
  void addTooLarge() {
    if (!keepsAny()) return;
    dropped_ += 1 + done_.clear();
    ++tooLarge_;
  }

  /// Undoes the last change: calls `exchange(change)`, which exchanges what the change has stored with what is present.
  /// False if there is no change to undo, or `exchange` returns false; then, and if it throws, the list is unchanged.
  template <class Exchange>
  bool undo(const Exchange& exchange) {
    dropped_ += fetch(done_);
    const bool isDone = move(done_, undone_, exchange);
    dropped_ += fetch(done_);
    return isDone;
  }
  /// The same for the change undone last.
  template <class Exchange>
  bool redo(const Exchange& exchange) {
    fetch(undone_);
    return move(undone_, done_, exchange);
  }

  /// The change that undo() takes next; null: none.
  const Change* last() const { return done_.near.empty() ? nullptr : &done_.near.back(); }
  std::size_t undoCount() const { return done_.count(); }
  std::size_t redoCount() const { return undone_.count(); }
  /// Changes that can no longer be undone because of the budget; of these, those larger than the whole budget.
  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t tooLarge() const { return tooLarge_; }
  /// Memory of the changes.
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Side {
    explicit Side(const UndoBudget& budget) {
      if (budget.bytes > 0 && !budget.folder.empty()) far.emplace(budget.folder, budget.disk_bytes);
    }
    std::size_t count() const { return near.size() + (far ? far->count() : 0); }
    // Returns the number of removed changes.
    std::size_t clear() {
      const std::size_t count = this->count();
      near.clear();
      if (far) far->clear();
      return count;
    }

    std::deque<Change> near;         // the last one is the next
    std::optional<KeptChanges> far;  // before those
  };
  void keepLast() {
    begin();
    bytes_ += bytesOf(done_.near.back());
    while (bytes_ > budget_ && done_.near.size() > 1) dropped_ += putAway(done_);
    if (bytes_ <= budget_) return;
    bytes_ -= bytesOf(done_.near.back());
    done_.near.pop_back();
    addTooLarge();
  }
  // Moves the farthest change in memory to the disk; returns the number of changes that are lost for it.
  std::size_t putAway(Side& side) {
    const std::size_t lost = side.far ? side.far->push(pack(side.near.front())) : 1;
    bytes_ -= bytesOf(side.near.front());
    side.near.pop_front();
    return lost;
  }
  // The next change is in memory, if there is any. Returns the number of changes that are lost, as the disk cannot be
  // read.
  std::size_t fetch(Side& side) {
    if (!side.near.empty() || side.count() == 0) return 0;
    Change change;
    const auto bytes = side.far->pop();
    if (!bytes || !unpack(*bytes, change)) return 1 + side.far->clear();
    bytes_ += bytesOf(change);
    side.near.push_back(std::move(change));
    return 0;
  }
  template <class Exchange>
  bool move(Side& from, Side& to, const Exchange& exchange) {
    if (from.near.empty()) return false;
    to.near.emplace_back();  // before the exchange, after which no memory may be missing
    Change& change = from.near.back();
    const std::uint64_t before = bytesOf(change);
    bool isDone = false;
    try {
      isDone = exchange(change);
    } catch (...) {
      to.near.pop_back();
      throw;
    }
    if (!isDone) {
      to.near.pop_back();
      return false;
    }
    bytes_ += bytesOf(change) - before;
    to.near.back() = std::move(change);
    from.near.pop_back();
    while (to.far && bytes_ > budget_ && to.near.size() > 1) putAway(to);
    return true;
  }

  std::uint64_t budget_;
  Side done_, undone_;
  std::uint64_t bytes_ = 0;  // of the changes in memory
  std::uint64_t dropped_ = 0, tooLarge_ = 0;
};

}  // namespace palpate
