#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/point_state.hpp"

namespace palpate {

/// Passes changes of points from a thread that offers them to the thread that answers poses, which carries them out:
/// one offer at a time. Neither waits for the other.
class OfferedChanges {
 public:
  /// `most`: maximum number of changes in an offer; 0: no offers are accepted.
  explicit OfferedChanges(std::size_t most) : most_(most) { changes_.reserve(most); }

  std::size_t most() const { return most_; }

  /// For the thread that offers. False while the last offer is pending.
  bool give(std::span<const PointChange> changes, std::uint64_t changesFollowed) {
    if (most_ == 0 || changes.size() > most_ || isThere()) return false;
    changes_.assign(changes.begin(), changes.end());
    changesFollowed_ = changesFollowed;
    isThere_.store(true, std::memory_order_release);
    return true;
  }

  // For the thread that answers; changes() and changesFollowed() only while an offer is pending.
  bool isThere() const { return isThere_.load(std::memory_order_acquire); }
  std::span<const PointChange> changes() const { return changes_; }
  /// Number of EditStream::change() calls that the offering thread knew of.
  std::uint64_t changesFollowed() const { return changesFollowed_; }
  /// The offer was carried out or dropped.
  void done() { isThere_.store(false, std::memory_order_release); }

 private:
  std::size_t most_;
  std::vector<PointChange> changes_;
  std::uint64_t changesFollowed_ = 0;
  std::atomic<bool> isThere_ = false;
};

}  // namespace palpate
