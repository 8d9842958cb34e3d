// Edits of one hand on their way to the server. Independent of DDS. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "haptics/sharing/point_digest.hpp"

namespace palpate::sharing {

/// States that a hand has made, on their way to the server.
struct StrokePiece {
  std::uint64_t number = 0;  ///< from 1, without gaps
  std::vector<PointState> states;
  std::vector<std::uint64_t> replaced = {};  ///< MadeState::replaced of each of them; empty: they replace any
};

/// Numbered pieces, each kept until it is known to be taken. Edits made meanwhile are merged: each point is sent once,
/// with its last state.
class StrokeOutbox {
 public:
  void add(const MadeState& made);
  /// The next piece to send, of at most `most` states, and a ninth less with those that they replace; null if there is
  /// none, or too many are in flight. It is kept until it is taken.
  const StrokePiece* nextPiece(std::size_t most);
  /// The last result of nextPiece() could not be sent: it is returned again.
  void notSent() { --toSend_; }
  /// All pieces up to this one were taken. Returns the points without edits in flight any more.
  std::vector<std::uint32_t> taken(std::uint64_t upTo);
  /// What was sent and not taken is sent again.
  void sendAgain();

  /// An edit of this point was not taken yet.
  bool holds(std::uint32_t point) const { return queued_.contains(point) || pending_.contains(point); }
  bool isEmpty() const { return queue_.empty() && unacked_.empty(); }
  std::uint64_t lastPiece() const { return lastPiece_; }    ///< last one ever made
  std::uint64_t sentStates() const { return sentStates_; }  ///< each piece once
  std::uint64_t resent() const { return resent_; }          ///< pieces sent more than once

 private:
  std::deque<std::uint32_t> queue_;  // points, in the order of sending
  std::unordered_map<std::uint32_t, MadeState> queued_;
  std::deque<StrokePiece> unacked_;
  std::unordered_map<std::uint32_t, std::uint64_t> pending_;  // by point: the last piece that has it
  std::uint64_t lastPiece_ = 0;
  std::size_t toSend_ = 0;  // index into unacked_: pieces from here on are sent again
  std::uint64_t sentStates_ = 0, resent_ = 0;
};

}  // namespace palpate::sharing
