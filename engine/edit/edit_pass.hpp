#pragma once

#include <optional>
#include <span>

#include "engine/core/brush.hpp"
#include "engine/core/point_state.hpp"
#include "engine/edit/brush_moves.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_sequel.hpp"
#include "engine/edit/given_changes.hpp"
#include "engine/edit/resample.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// Everything that an edit does to the live cloud in one tick: the brush, or changes as they are given; points that
/// come and go to keep the surface whole; the index, by update or by a full build; the normals of what changed; the
/// log.
class EditPass {
 public:
  /// `colors`: RGBA8 of the cloud's points, empty when it has none and none are painted. `radius`: support radius,
  /// model units. `live` and `log` must outlive the pass.
  EditPass(Device& device, const BrushOptions& brush, const SpatialHash& hash, const LiveCloud& live,
           const EditLog& log, std::span<const std::uint32_t> colors, double radius);
  EditPass(const EditPass&) = delete;
  EditPass& operator=(const EditPass&) = delete;

  /// Another brush from now on: what was recorded with the one before must be recorded again. Nothing may run
  /// meanwhile. It keeps the density only where the first brush did.
  void setBrush(const BrushOptions& brush) { moves_.setBrush(brush); }
  /// Where the tool is in the edit that is submitted next. While none is under way.
  void setTool(const BrushStroke::Tool& tool) { moves_.setTool(tool); }

  /// Where a brush looks for the points that it reaches: in the cells of a box, which fails with kUpdateTooLarge where
  /// they are more than mostMoves(); or, with a full build, among all points, as many at a time.
  enum class Reach { near, far, all };
  /// The one that the tool asks for.
  Reach reach() const { return moves_.box() == BrushMoves::Box::far ? Reach::far : Reach::near; }

  // Of the brush, for the tool of that time; recorded ahead. Two sections: "edit", after which points, index,
  // normals and log are as the brush leaves them, and "requests", which prepares what the next edit does besides.
  /// At the cost of the points that it reaches: the points on `half` and their index change in place.
  void recordIncremental(CommandList& list, const LiveCloud::Half& half, Reach reach) const;
  /// With a full build: reads `from` and writes `to`; the caller flips the cloud.
  void recordRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, SortMethod sort,
                     Reach reach) const;

  // Of changes as they are given, at most mostChanges() at a time; recorded after give(). Of those that are offered a
  // point that does not stand where its change says stays as it is; without that none of them is carried out then.
  enum class Given { exactly, offered };
  std::uint32_t mostChanges() const { return given_.most(); }
  void give(std::span<const PointChange> changes) { given_.give(changes, live_.slots()); }
  void recordGivenIncremental(CommandList& list, const LiveCloud::Half& half, Given given) const;
  void recordGivenRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, SortMethod sort,
                          Given given) const;
  /// A full build and nothing else: the points on `from` stand without gaps on `to`.
  void recordCompaction(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                        SortMethod sort) const;

  /// True where the last edit that has completed left requests: another one would change something though no brush
  /// acts.
  bool unsettled() const { return resamples() && resample_->unsettled(); }
  /// How the edits so far have found the surface under the tool: sums over all of them.
  SurfaceMeasure measure() const;
  /// What the last edit that has completed came to.
  const shared::HashUpdate& report() const { return update_.report(); }
  const HashUpdate& update() const { return update_; }
  std::uint32_t mostMoves() const { return update_.mostMoves(); }
  /// Entries that an edit with a full build may add to the log.
  std::uint64_t mostLogged(Reach reach) const;
  const BrushOptions& brush() const { return moves_.brush(); }

  /// Completes a point, of which LiveCloud::points() knows place and normal, with its colour and parent.
  void complete(std::vector<PointState>& points) const;
  std::uint64_t bytes() const;
  /// The same for a cloud that is not there yet.
  static std::uint64_t predictedBytes(std::uint64_t points, bool colors);

 private:
  using Scratch = EditSequel::Scratch;

  // Paint moves nothing, so that no points come or go with it.
  bool resamples() const { return resample_ && brush().keepsDensity && brush().kind != BrushKind::paint; }
  std::uint32_t recalls() const { return resamples() ? shared::kRecallsRequests : shared::kRecallsNothing; }
  // What follows an update goes by.
  Scratch scratch() const { return {.changed = update_.changed(), .fitted = update_.fitted()}; }
  // Behind a build: any number of them.
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

  // Of an edit with a full build: what the brush makes of the points, where they stand.
  void recordReached(CommandList& list, const LiveCloud::Half& from, Reach reach) const;
  // Of changes as they are given. `flags`: shared::kRestore...
  void recordRestore(CommandList& list, const LiveCloud::Half& half, Given given, std::uint32_t flags) const;
  // Requests of the last tick are dropped.
  void recordForget(CommandList& list, const LiveCloud::Half& half) const;
  // What follows once the index has: normals and log. Makes an end to the update, unless `requests` follow.
  void recordSequel(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch,
                    bool requests) const;
  // Where points should come and go with the next edit. Makes an end to the update.
  void recordRequests(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                      const Scratch& scratch) const;

  Device& device_;
  const SpatialHash& hash_;
  const LiveCloud& live_;
  HashUpdate update_;
  BrushMoves moves_;
  GivenChanges given_;
  EditSequel sequel_;
  Buffer tables_, colors_, parents_, founds_;
  std::optional<Resample> resample_;
};

}  // namespace palpate
