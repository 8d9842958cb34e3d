// How what one hand does to a shared cloud and what the others do to it come together, on the machine of that hand.
// Nothing of DDS is seen here. One thread uses it at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "haptics/sharing/point_digest.hpp"
#include "haptics/sharing/stroke_outbox.hpp"

namespace palpate::sharing {

/// What the server says to one client.
struct Results {
  std::uint32_t epoch = 0;    ///< of the request that they answer
  std::uint64_t counter = 0;  ///< in that epoch, from 1 on
  std::uint64_t acked = 0;    ///< the last piece of this client that was taken
  std::uint64_t upTo = 0;     ///< of the order of all: it is known up to here
  std::uint64_t head = 0;     ///< and goes up to here
  std::uint64_t digest = 0;   ///< of all points, at `head`
  std::span<const PointState> states;
};

/// What is asked of the server: all from `upTo` on, in an epoch of its own.
struct Resume {
  std::uint32_t epoch = 0;
  std::uint64_t upTo = 0;
};

/// What the hand has done is in effect at once, and is sent; what others have done is offered to what answers the hand.
/// The server's order decides: what is on the way there comes after all that is known here, so a point that this hand
/// has changed stays as it is until the server has it. In the end every point is everywhere as it was changed last.
class EditExchange {
 public:
  /// `points`: by id, as they were joined. `mostOffered`: TouchBackend::mostOffered().
  EditExchange(std::vector<PointState> points, std::size_t mostOffered);

  // Of the hand.
  /// What was done to the points, in order (TouchBackend::takeEdits()).
  void follow(const EditBatch& batch);
  /// What others did, for TouchBackend::offer(); nothing while the last offer has not been reported.
  std::span<const PointChange> nextOffer();
  /// What goes with it.
  std::uint64_t changesFollowed() const { return changesFollowed_; }
  /// They were taken.
  void offered() { isOffered_ = true; }
  /// They are there to be taken, or were, and what became of them is not known yet.
  bool isOffering() const { return isOffered_ || !inFlight_.empty(); }

  // Of the server.
  enum class Heard {
    taken,
    old,  ///< of an epoch before
    gap   ///< something is missing: resume()
  };
  Heard hear(const Results& results);
  /// Asks for what is missing. What was sent and has not been taken is sent again.
  Resume resume();
  /// Asks how far the server is. Until it answers, isInEffect() is false: an earlier message may lack strokes that the
  /// server has already taken. Sends nothing again.
  Resume ask();
  /// The same from the beginning on, what this hand has made included.
  Resume resumeAll();
  /// What this hand has made, to be sent.
  StrokeOutbox& outbox() { return outbox_; }

  /// All that the server had as it was heard last is in effect here.
  bool isInEffect() const { return hasHeard_ && inFlight_.empty() && waiting_.empty() && upTo_ == head_; }
  /// Nothing is on the way in either direction.
  bool isAtRest() const { return isInEffect() && isDelivered(); }
  /// All that this hand has done is where it belongs.
  bool isDelivered() const { return outbox_.isEmpty(); }
  /// At rest: whether the points here are those of the server.
  bool isSame() const { return digest_.value() == serverDigest_; }

  std::span<const PointState> points() const { return shown_; }
  std::uint64_t digest() const { return digest_.value(); }
  std::uint64_t upTo() const { return upTo_; }
  std::uint64_t sentStates() const { return outbox_.sentStates(); }  ///< of this hand, each piece once
  std::uint64_t receivedStates() const { return receivedStates_; }   ///< of others, as they took effect here
  std::uint64_t resent() const { return outbox_.resent(); }          ///< pieces that went more than once

 private:
  using ByPoint = std::unordered_map<std::uint32_t, PointState>;
  void set(const PointState& state);
  void made(const PointState& state);
  void received(std::span<const PointState> states);

  std::vector<PointState> shown_;  // as what answers the hand has them, as far as it has said
  std::size_t mostOffered_;
  PointDigest digest_;

  StrokeOutbox outbox_;

  // Made by others: not offered yet; offered; and of those what this hand has made meanwhile.
  ByPoint waiting_, inFlight_, overtaken_;
  std::vector<PointChange> offer_;
  bool isOffered_ = false;
  std::uint64_t changesFollowed_ = 0;

  std::uint32_t epoch_ = 0;
  std::uint64_t counter_ = 0, upTo_ = 0, head_ = 0, serverDigest_ = 0;
  bool hasHeard_ = false;  // in this epoch
  std::uint64_t receivedStates_ = 0;
};

}  // namespace palpate::sharing
