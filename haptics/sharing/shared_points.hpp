// What a server knows of a cloud that several sculpt: each point as it is, and in which order it became so. Nothing of
// DDS is seen here. One thread uses it at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "engine/core/point_state.hpp"
#include "haptics/sharing/id.hpp"
#include "haptics/sharing/point_digest.hpp"

namespace palpate::sharing {

/// The points of a session. Clients send the states that their brushes have made, in numbered pieces; each state that
/// is taken gets the next number of one order for all, and the last one of a point is what it is.
class SharedPoints {
 public:
  /// `points`: by id, as they are served.
  explicit SharedPoints(std::vector<PointState> points);

  enum class Taken {
    taken,
    known,   ///< it has been taken before: nothing is done twice
    early,   ///< one before it is missing: it has to come again
    refused  ///< no client of ours makes it
  };
  /// The `number`-th piece of `client`, from 1 on; all of it or nothing.
  Taken take(const Id& client, std::uint64_t number, std::span<const PointState> states);
  /// The last piece of a client that was taken; 0 before the first.
  std::uint64_t lastOf(const Id& client) const;

  /// Of the last state that was taken; 0 before the first.
  std::uint64_t head() const { return first_ + order_.size() - 1; }
  std::uint64_t digest() const { return digest_.value(); }
  std::span<const PointState> points() const { return points_; }
  std::size_t clients() const { return clients_.size(); }

  /// How far somebody who follows has come.
  struct Place {
    std::uint64_t upTo = 0;     ///< has all states up to this one, or later ones of the same points
    std::uint64_t scanned = 0;  ///< points that were looked through, where the order before is not kept any more
    std::uint64_t scanEnd = 0;  ///< head() when the scan began; 0: none is under way
    std::uint64_t ownUpTo = 0;  ///< up to here it gets what it has made itself, too
  };
  /// Appends at most `most` states that are newer than `place`, as they are now, and moves it. What `receiver` made
  /// last is left out, beyond Place::ownUpTo. Where a point has changed again since, its last state is given once.
  void collect(Place& place, const Id& receiver, std::size_t most, std::vector<PointState>& states) const;
  bool isBehind(const Place& place) const { return place.upTo < head(); }

 private:
  struct Client {
    std::uint32_t number = 0;
    std::uint64_t last = 0;
  };
  struct Last {
    std::uint64_t number = 0;  // in the order of all; 0: as it was served
    std::uint32_t client = 0;
  };
  void scan(Place& place, std::uint32_t receiver, std::size_t end, std::vector<PointState>& states) const;

  std::vector<PointState> points_;
  std::vector<Last> last_;  // by point
  std::map<Id, Client> clients_;
  std::deque<std::uint32_t> order_;  // points, from the first_-th number on
  std::uint64_t first_ = 1;
  std::size_t mostOrder_;
  PointDigest digest_;
};

/// Whether a client of ours can have made it of a cloud of so many points.
bool isWhole(const PointState& state, std::size_t points);

}  // namespace palpate::sharing
