// Merges one hand's edits of a shared cloud with those of the others, on the machine of that hand. Independent of DDS.
// Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "haptics/sharing/point_digest.hpp"
#include "haptics/sharing/sample_order.hpp"
#include "haptics/sharing/stroke_outbox.hpp"

namespace palpate::sharing {

/// Message of the server to one client.
struct Results {
  std::uint32_t epoch = 0;   ///< of the request that it answers
  std::uint64_t sample = 0;  ///< number in that epoch, from 1
  std::uint64_t acked = 0;   ///< last piece of this client that the server has taken
  std::uint64_t upTo = 0;    ///< position in the common order up to which changes are known
  std::uint64_t head = 0;    ///< end of the common order
  std::uint64_t digest = 0;  ///< checksum of all points, at `head`
  std::span<const PointState> states;
};

/// Request for all changes after `upTo`, in an epoch of its own.
struct Resume {
  std::uint32_t epoch = 0;
  std::uint64_t upTo = 0;
};

/// The hand's edits take effect at once and are sent; edits of others are offered to the back end. The server's order
/// decides: edits in flight to it come after all that is known here, so a point that this hand has changed stays as it
/// is until the server has it. In the end every copy has each point as it was changed last.
class EditExchange {
 public:
  /// `points`: by id, as joined. `mostOffered`: EditStream::mostOffered().
  EditExchange(std::vector<PointState> points, std::size_t mostOffered);

  // The hand's side.
  /// Edits of the points, in order (EditStream::take()).
  void follow(const EditBatch& batch);
  /// Edits of others, for EditStream::offer(); empty until the last offer is reported.
  std::span<const PointChange> nextOffer();
  /// Passed with the offer.
  std::uint64_t changesFollowed() const { return changesFollowed_; }
  /// The back end has accepted the offer.
  void offered() { isOffered_ = true; }
  /// The offer is pending, or its result is not known yet.
  bool isOffering() const { return isOffered_ || !inFlight_.empty(); }

  // The server's side.
  /// A gap: call resume().
  Heard hear(const Results& results);
  /// Requests missing changes. Pieces that were sent and not taken are sent again.
  Resume resume();
  /// Asks how far the server is. Until it answers, isInEffect() is false: an earlier message may lack strokes that the
  /// server has already taken. Resends nothing.
  Resume ask();
  /// resume() from the beginning, including this hand's own edits.
  Resume resumeAll();
  /// This hand's edits, to be sent.
  StrokeOutbox& outbox() { return outbox_; }

  /// All changes that the server had at its last message are in effect here.
  bool isInEffect() const { return hasHeard_ && inFlight_.empty() && waiting_.empty() && upTo_ == head_; }
  /// Nothing is in flight in either direction.
  bool isAtRest() const { return isInEffect() && isDelivered(); }
  /// The server has taken all edits of this hand.
  bool isDelivered() const { return outbox_.isEmpty(); }
  /// At rest: whether the points equal those of the server.
  bool isSame() const { return digest_.value() == serverDigest_; }

  std::span<const PointState> points() const { return shown_; }
  std::uint64_t digest() const { return digest_.value(); }
  std::uint64_t upTo() const { return upTo_; }
  /// Messages received in this epoch.
  std::uint64_t taken() const { return order_.taken(); }
  std::uint64_t sentStates() const { return outbox_.sentStates(); }  ///< of this hand, each piece once
  std::uint64_t receivedStates() const { return receivedStates_; }   ///< of others, counted when they take effect here
  std::uint64_t resent() const { return outbox_.resent(); }          ///< pieces sent more than once

 private:
  using ByPoint = std::unordered_map<std::uint32_t, PointState>;
  void set(const PointState& state);
  enum class Replaces { any, known };
  void made(const PointState& state, Replaces replaces);
  void received(std::span<const PointState> states);

  std::vector<PointState> shown_;  // as the back end has them, as far as it has reported
  std::size_t mostOffered_;
  PointDigest digest_;

  StrokeOutbox outbox_;

  // Edits of others: not offered yet; offered; overtaken_: the hand's own edits of offered points since.
  ByPoint waiting_, inFlight_, overtaken_;
  std::vector<PointChange> offer_;
  bool isOffered_ = false;
  std::uint64_t changesFollowed_ = 0;

  SampleOrder order_;
  std::uint64_t upTo_ = 0, head_ = 0, serverDigest_ = 0;
  bool hasHeard_ = false;  // a message of this epoch
  std::uint64_t receivedStates_ = 0;
};

}  // namespace palpate::sharing
