#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "engine/core/edit_batch.hpp"
#include "engine/core/error.hpp"
#include "engine/core/point_lock.hpp"

namespace palpate {

/// Number of point states that can still be queued for the followers of the edits, and the total capacity.
struct EditRoom {
  std::uint64_t free = 0, capacity = 0;
};

/// How far the edits are, so that answers and edits can be ordered.
struct EditProgress {
  /// Number of states that take() has reported or will report from before the last answer (kept or not).
  std::uint64_t states = 0;
  std::uint64_t dropped = 0;  ///< edits that were not made (TouchShortfalls)
};

/// What brushes could not do so far, because points stop before a side that stays (engine/edit/README.md).
struct BlockedMoves {
  std::uint64_t moves = 0;  ///< moves of points for which there was no room: in each edit, one for each such point
  std::uint64_t edits = 0;  ///< edits in which nearly all points under the brush were blocked
  /// Edits without an effect, since all points around the hand face away from it, as at the back of an open surface,
  /// and ticks of a hand with its button pressed that is behind the surface and touches nothing.
  std::uint64_t fromBehind = 0;
};

/// The edits of a cloud, in order, for their followers: a history, a session log, other machines. All changes of the
/// points by other means than a brush go through it, too.
class EditStream {
 public:
  virtual ~EditStream() = default;

  /// From now on edits are kept for take(). Before the first query.
  virtual void keep() = 0;
  /// Appends all edits since the last call, in order. For one thread, which may differ from the thread that queries and
  /// does not delay it. If the back end's throughput queue is used too: for the thread that uses that queue.
  virtual void take(EditBatch& batch) = 0;
  /// Free space of the edit log, if edits are dropped when it is full; empty if it is unlimited. For any thread.
  virtual std::optional<EditRoom> room() const { return std::nullopt; }
  /// Allocates nothing. For the thread that queries.
  virtual EditProgress progress() const noexcept = 0;
  /// For any thread. Zero where points do not look ahead.
  virtual BlockedMoves blocked() const noexcept { return {}; }
  /// Ends the stroke in progress, if any, and sets points exactly to `to` of `changes`: moved, removed, restored or
  /// new, each of them once. Complete on return; take() reports it with a mark of its own. For the thread that queries,
  /// between queries. Throws Error where points cannot be edited, or if a point is not at the position in its change:
  /// then no point has changed, and take() reports nothing.
  virtual void change(std::span<const PointChange> changes) = 0;
  /// From now on brushes leave these points as they are, and others by the weights of their locks. Ends the stroke in
  /// progress; otherwise as change(). Throws Error where points cannot be locked.
  virtual void lock(const PointLock& lock) {
    if (!lock.empty()) throw Error("points cannot be locked here");
  }
  /// From now on these points cannot be felt, and all others can. Otherwise as lock(), but take() reports nothing of
  /// it; what others do to a hidden point it reports. `present`: the states of all points by number, according to all
  /// edits taken so far; it is called until no point is hidden.
  using PresentStates = std::function<std::span<const PointState>()>;
  virtual void hide(const PointSet& points, const PresentStates& /*present*/) {
    if (!points.empty()) throw Error("points cannot be hidden here");
  }
  /// From now on the points of `changed` are in their states of `states`, by number, where others are already; but
  /// those of `without`, all of which vanish now or have before, cannot be felt. After all edits were taken, of points
  /// that have existed. Costs a build of the index. Otherwise as change(), but take() reports nothing of it. False
  /// where that cannot be done.
  virtual bool replace(const PointSet& /*changed*/, std::span<const PointState> /*states*/,
                       const PointSet& /*without*/) {
    return false;
  }
  /// As change() of points that have existed, which may have vanished: `states` are those of all points by number,
  /// after that. False, and nothing has changed, where change() is sooner.
  virtual bool changeMany(const PointSet& /*points*/, std::span<const PointState> /*states*/) { return false; }
  /// Offers changes made elsewhere, at most mostOffered(), each point once. They are carried out between later answers,
  /// and no answer waits for them: a point that is not in its change's `from` state is unchanged. They do not end a
  /// stroke. take() reports their result once, with a mark of its own (EditMark::Kind::received). `changesFollowed`:
  /// number of change() marks that the caller has taken; if there are more, the offer is dropped. False while the last
  /// offer has not been reported. For one thread, which may differ from the thread that queries.
  virtual bool offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) = 0;
  /// 0: nothing can be offered, as where points are inserted and removed to keep the surface whole.
  virtual std::size_t mostOffered() const = 0;
};

}  // namespace palpate
