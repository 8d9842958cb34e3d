// A server's state of a cloud that several clients sculpt: each point as it is, and the order of all changes.
// Independent of DDS. Not thread-safe.
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

/// The points of a session. Clients send the states that their brushes have made, in numbered pieces. Each state that
/// is taken gets the next number of one common order; the last state of a point is its current one.
class SharedPoints {
 public:
  /// `points`: by id, as served.
  explicit SharedPoints(std::vector<PointState> points);

  enum class Taken {
    taken,
    known,   ///< a duplicate: nothing is done
    early,   ///< an earlier piece is missing: it has to be sent again
    refused  ///< no palpate client makes it
  };
  /// The `number`-th piece of `client`, from 1; it is taken as a whole or not at all. `replaced`: PointDigest::of() the
  /// state that each of them replaces, or empty. A point that has another state then keeps it, and everyone gets that
  /// once more, the client included.
  Taken take(const Id& client, std::uint64_t number, std::span<const PointState> states,
             std::span<const std::uint64_t> replaced = {});
  /// The last piece of a client that was taken; 0 before the first.
  std::uint64_t lastOf(const Id& client) const;

  /// Number of the last state that was taken; 0 before the first.
  std::uint64_t head() const { return first_ + order_.size() - 1; }
  std::uint64_t digest() const { return digest_.value(); }
  std::span<const PointState> points() const { return points_; }
  std::size_t clients() const { return clients_.size(); }

  /// How far a client has followed the order.
  struct Place {
    std::uint64_t upTo = 0;     ///< it has all states up to this one, or later ones of the same points
    std::uint64_t scanned = 0;  ///< points scanned, if the order before is no longer kept
    std::uint64_t scanEnd = 0;  ///< head() when the scan began; 0: no scan is in progress
    std::uint64_t ownUpTo = 0;  ///< up to here it gets its own changes, too
  };
  /// Appends at most `most` states that are newer than `place`, as they are now, and advances it. Points that
  /// `receiver` changed last are left out beyond Place::ownUpTo. A point that has changed several times is given once.
  void collect(Place& place, const Id& receiver, std::size_t most, std::vector<PointState>& states) const;
  bool isBehind(const Place& place) const { return place.upTo < head(); }

 private:
  struct Client {
    std::uint32_t number = 0;
    std::uint64_t last = 0;
  };
  struct Last {
    std::uint64_t number = 0;  // in the common order; 0: as served
    std::uint32_t client = 0;  // from 1; 0: none, as where nothing has changed
  };
  void scan(Place& place, std::uint32_t receiver, std::size_t end, std::vector<PointState>& states) const;

  std::vector<PointState> points_;
  std::vector<Last> last_;  // by point
  std::map<Id, Client> clients_;
  std::deque<std::uint32_t> order_;  // points, beginning with the number first_
  std::uint64_t first_ = 1;
  std::size_t mostOrder_;
  PointDigest digest_;
};

/// Whether a palpate client can have made it, for a cloud of that many points.
bool isWhole(const PointState& state, std::size_t points);

}  // namespace palpate::sharing
