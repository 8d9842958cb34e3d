// What one hand has made of points, on its way to the server. Nothing of DDS is seen here. One thread uses it at a
// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "engine/core/point_state.hpp"

namespace palpate::sharing {

/// States that a hand has made, on their way to the server.
struct StrokePiece {
  std::uint64_t number = 0;  ///< from 1 on, without gaps
  std::vector<PointState> states;
};

/// Numbered pieces, each kept until it is known to have been taken. What is made while it waits goes once for each
/// point, as it was made last.
class StrokeOutbox {
 public:
  void add(const PointState& state);
  /// The next piece to send, of at most `most` states; null where there is none, or so many are on the way that they
  /// have to arrive first. It stays until it has been taken.
  const StrokePiece* nextPiece(std::size_t most);
  /// The one that nextPiece() gave last could not be sent: it is the next one again.
  void notSent() { --toSend_; }
  /// All pieces up to this one were taken. Gives the points of which nothing is on the way any more.
  std::vector<std::uint32_t> taken(std::uint64_t upTo);
  /// What was sent and has not been taken goes again.
  void sendAgain();

  /// Something of this point has not been taken.
  bool holds(std::uint32_t point) const { return queued_.contains(point) || pending_.contains(point); }
  bool isEmpty() const { return queue_.empty() && unacked_.empty(); }
  std::uint64_t lastPiece() const { return lastPiece_; }    ///< that was ever made
  std::uint64_t sentStates() const { return sentStates_; }  ///< each piece once
  std::uint64_t resent() const { return resent_; }          ///< pieces that went more than once

 private:
  std::deque<std::uint32_t> queue_;  // points, in the order in which they go
  std::unordered_map<std::uint32_t, PointState> queued_;
  std::deque<StrokePiece> unacked_;
  std::unordered_map<std::uint32_t, std::uint64_t> pending_;  // by point: the last piece that has it
  std::uint64_t lastPiece_ = 0;
  std::size_t toSend_ = 0;  // of unacked_, where pieces go again: from here on
  std::uint64_t sentStates_ = 0, resent_ = 0;
};

}  // namespace palpate::sharing
