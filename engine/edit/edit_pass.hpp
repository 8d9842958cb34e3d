#pragma once

#include <optional>
#include <span>

#include "engine/core/brush.hpp"
#include "engine/core/point_lock.hpp"
#include "engine/core/point_state.hpp"
#include "engine/edit/brush_moves.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_sequel.hpp"
#include "engine/edit/given_changes.hpp"
#include "engine/edit/many_changes.hpp"
#include "engine/edit/resample.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// All steps of an edit of the live cloud in one tick: the brush, or given changes; insertions and removals that keep
/// the surface whole; the index, by update or rebuild; the normals of changed points; the log.
class EditPass {
 public:
  /// `colors`: RGBA8 of the cloud's points, empty if it has no colours and is not painted. `radius`: support radius,
  /// model units. `live` and `log` must outlive the pass.
  EditPass(Device& device, const BrushOptions& brush, const SpatialHash& hash, const LiveCloud& live,
           const EditLog& log, std::span<const std::uint32_t> colors, double radius);
  EditPass(const EditPass&) = delete;
  EditPass& operator=(const EditPass&) = delete;

  /// Replaces the brush: lists recorded with the previous one must be recorded again. Nothing may run meanwhile.
  void setBrush(const BrushOptions& brush);
  /// From now on the brush leaves these points as they are, and no others. Nothing may run meanwhile.
  void lock(const PointLock& lock);
  /// Sets the tool of the edit that is submitted next. Not during an edit.
  void setTool(const BrushStroke::Tool& tool) { moves_.setTool(tool); }

  /// The search range of a brush: the cells of a box, which fails with kUpdateTooLarge if more than mostMoves() points
  /// are reached; or, with a rebuild, all points, mostMoves() at a time.
  enum class Reach { near, far, all };
  /// The range that the current tool requires.
  Reach reach() const { return moves_.box() == BrushMoves::Box::far ? Reach::far : Reach::near; }

  // Edits by the brush, with the tool of the time of execution; recorded ahead. Two sections: "edit", after which
  // points, index, normals and log are complete, and "requests", in which points look ahead, and the insertions and
  // removals of the next edit are prepared.
  /// At the cost of the points reached: the points on `half` and their index change in place.
  void recordIncremental(CommandList& list, const LiveCloud::Half& half, Reach reach) const;
  /// With a rebuild: reads `from` and writes `to`; the caller flips the cloud.
  void recordRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, SortMethod sort,
                     Reach reach) const;

  // Given changes, at most mostChanges() at a time; recorded after give(). If a point is not in its change's `from`
  // state: when offered, only that point stays as it is; otherwise none of the changes is carried out.
  enum class Given { exactly, offered };
  std::uint32_t mostChanges() const { return given_.most(); }
  void give(std::span<const PointChange> changes) { given_.give(changes, live_.slots()); }
  void recordGivenIncremental(CommandList& list, const LiveCloud::Half& half, Given given) const;
  void recordGivenRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, SortMethod sort,
                          Given given) const;
  /// Carries out many at once (ManyChanges), without a check of their states. Waits.
  void carryOut(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
    many_.carryOut(live_, tables_, changed, states, without);
  }
  /// Drops the requests of the last edit.
  void recordForgetting(CommandList& list, const LiveCloud::Half& half) const;
  /// Only rebuilds: the points on `from` are stored without gaps on `to`.
  void recordCompaction(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                        SortMethod sort) const;

  /// True if the last completed edit left requests: another one would change points even though no brush acts.
  bool unsettled() const { return resamples() && resample_.unsettled(); }
  /// Measures of the surface under the tool: sums over all edits so far.
  SurfaceMeasure measure() const;
  /// Result of the last completed edit.
  const shared::HashUpdate& report() const { return update_.report(); }
  const HashUpdate& update() const { return update_; }
  std::uint32_t mostMoves() const { return update_.mostMoves(); }
  /// Maximum number of log entries of an edit with a rebuild.
  std::uint64_t mostLogged(Reach reach) const;
  const BrushOptions& brush() const { return moves_.brush(); }

  /// Adds colour and parent to points whose positions and normals are from LiveCloud::points().
  void complete(std::vector<PointState>& points) const;
  std::uint64_t bytes() const;
  /// The same for a cloud that does not exist yet.
  static std::uint64_t predictedBytes(std::uint64_t points, bool colors);

 private:
  using Scratch = EditSequel::Scratch;

  bool resamples() const { return brush().resample && brushHas(brush().kind, shared::kMayResample); }
  // Whether points that have moved are examined: for requests, or to look ahead.
  bool examines() const { return resamples() || brushHas(brush().kind, shared::kLooksAhead); }
  std::uint32_t recalls() const { return resamples() ? shared::kRecallsRequests : shared::kRecallsNothing; }
  // Lists for the passes that follow an update.
  Scratch scratch() const { return {.changed = update_.changed(), .fitted = update_.fitted()}; }
  // After a rebuild: of any number of points.
  Scratch scratch(const LiveCloud::Half& left) const {
    return {.changed = update_.bySlot(), .fitted = left.normals.address()};
  }
  BrushMoves::Io movesIo(const shared::CloudView& cloud, std::uint32_t parity) const;
  bool hasBox(Reach reach) const { return reach != Reach::all && moves_.has(boxOf(reach)); }
  static BrushMoves::Box boxOf(Reach reach) {
    return reach == Reach::near ? BrushMoves::Box::near : BrushMoves::Box::far;
  }
  EditSequel::Io sequelIo(const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch) const;
  Resample::Io resampleIo(const shared::CloudView& cloud, std::uint32_t parity) const;
  shared::EditEnd end() const;
  shared::CloudView view(const LiveCloud::Half& half) const { return hash_.view(half, live_.slots()); }

  // The brush's changes in an edit with a rebuild, before the rebuild.
  void recordReached(CommandList& list, const LiveCloud::Half& from, Reach reach) const;
  // Given changes. `flags`: shared::kRestore...
  void recordRestore(CommandList& list, const LiveCloud::Half& half, Given given, std::uint32_t flags) const;
  void uploadTables();
  // Drops the requests of the last tick.
  void recordForget(CommandList& list, const LiveCloud::Half& half) const;
  // The passes after the index: normals and log. Ends the update, unless `requests` follow.
  void recordSequel(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch,
                    bool requests) const;
  // How far points may go on, and requests of insertions and removals for the next edit. Ends the update.
  void recordRequests(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                      const Scratch& scratch) const;

  Device& device_;
  const SpatialHash& hash_;
  const LiveCloud& live_;
  HashUpdate update_;
  BrushMoves moves_;
  GivenChanges given_;
  ManyChanges many_;
  EditSequel sequel_;
  Buffer tables_, colors_, parents_, founds_;
  std::optional<Buffer> locked_;       // since the first lock()
  std::optional<Buffer> lockWeights_;  // while any point is locked in part
  Resample resample_;
};

}  // namespace palpate
