#pragma once

#include <optional>
#include <span>

#include "engine/core/brush.hpp"
#include "engine/core/point_state.hpp"
#include "engine/edit/edit_log.hpp"
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

  /// Another brush from now on: what was recorded with the one before must be recorded again. Nothing may run
  /// meanwhile. It keeps the density only where the first brush did.
  void setBrush(const BrushOptions& brush);

  /// Where a brush with a full build looks for the points that it reaches: in the cells of its box, which fails with
  /// kUpdateTooLarge where they are more than mostMoves(); or among all points, as many at a time.
  enum class Reach { box, all };

  // Of the brush, for the contact state of this tick; recorded ahead. Two sections: "edit", after which points, index,
  // normals and log are as the brush leaves them, and "wishes", which prepares what the next edit does besides.
  /// At the cost of the points that it reaches: the points on `side` and their index change in place.
  void recordIncremental(CommandList& list, const LiveCloud::Side& side, const Buffer& contactState) const;
  /// With a full build: reads `from` and writes `to`; the caller flips the cloud.
  void recordRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                     const Buffer& contactState, SortMethod sort, Reach reach) const;

  // Of changes as they are given, at most mostChanges() at a time; recorded after give().
  std::uint32_t mostChanges() const { return mostChanges_; }
  void give(std::span<const PointChange> changes);
  void recordGivenIncremental(CommandList& list, const LiveCloud::Side& side) const;
  void recordGivenRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                          SortMethod sort) const;
  /// A full build and nothing else: the points on `from` stand without gaps on `to`.
  void recordCompaction(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                        SortMethod sort) const;

  /// True where the last edit that has completed left wishes: another one would change something though no brush acts.
  bool unsettled() const { return resamples() && resample_->unsettled(); }
  /// What the last edit that has completed came to.
  const shared::HashUpdate& report() const { return update_.report(); }
  const HashUpdate& update() const { return update_; }
  std::uint32_t mostMoves() const { return update_.mostMoves(); }
  /// Entries that an edit with a full build may add to the log.
  std::uint64_t mostLogged(Reach reach) const;
  const BrushOptions& brush() const { return options_; }

  /// Completes a point, of which LiveCloud::points() knows place and normal, with its colour and parent.
  void complete(std::vector<PointState>& points) const;
  std::uint64_t bytes() const;
  /// The same for a cloud that is not there yet.
  static std::uint64_t predictedBytes(std::uint64_t points, bool colors);

 private:
  // Where a brush looks for points: in the cells of its box, in slots, or nowhere.
  struct Selection {
    std::uint32_t cells = 0, firstSlot = 0, slots = 0;
  };
  Selection box() const;
  // Paint moves nothing, so that no points come or go with it.
  bool resamples() const { return resample_ && options_.keepsDensity && options_.kind != BrushKind::paint; }
  DeviceAddress wishLists() const { return resamples() ? resample_->lists() : 0; }
  // What follows an update goes by: the slots that have changed, and room for a vec4 for each of them.
  struct Scratch {
    DeviceAddress changed = 0, fitted = 0;
  };
  Scratch scratch() const { return {.changed = update_.changed(), .fitted = update_.fitted()}; }
  // Behind a build: any number of them.
  Scratch scratch(const LiveCloud::Side& left) const {
    return {.changed = update_.bySlot(), .fitted = left.normals.address()};
  }
  // `recalls`: kRecalls... of shaders/shared/edit.h.
  // Lists the brush's moves, and those that come of wishes.
  void recordMoves(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity, DeviceAddress contactState,
                   const Selection& selection, std::uint32_t recalls) const;
  // A pass that writes to the log.
  void recordLogging(CommandList& list, const ComputePipeline& pass, CountedDispatch::Step step, std::uint64_t groups,
                     const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch) const;
  void recordCollect(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                     DeviceAddress contactState, const Selection& selection, std::uint32_t recalls) const;
  void recordSmooth(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                    DeviceAddress contactState) const;
  // `finishes`: after the update, what it leaves to do.
  void recordRestore(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity, bool finishes) const;
  // Of an edit with a full build: what the brush makes of the points, where they stand.
  void recordReached(CommandList& list, const LiveCloud::Side& from, DeviceAddress contactState, std::uint32_t recalls,
                     Reach reach) const;
  // What follows once the index has: normals and log. Makes an end to the update, unless `wishes` follow.
  void recordSequel(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch,
                    bool wishes) const;
  // Where points should come and go with the next edit. Makes an end to the update.
  void recordWishes(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                    const Scratch& scratch) const;
  shared::EditEnd end() const;
  Resample::Io resampleIo(const shared::CloudView& cloud, std::uint32_t parity) const;
  shared::CloudView view(const LiveCloud::Side& side) const { return hash_.view(side, live_.slots()); }

  Device& device_;
  BrushOptions options_;
  const SpatialHash& hash_;
  const LiveCloud& live_;
  const EditLog& log_;
  double radius_;
  HashUpdate update_;
  std::uint32_t mostChanges_, given_ = 0;
  std::uint64_t boxCells_;  // of the tool's box, along one side; 0: looking at every slot is less
  ComputePipeline collect_, smooth_, restore_, refit_, logGone_, settle_;
  Buffer brush_, tables_, colors_, parents_, changes_;
  std::optional<Resample> resample_;
};

}  // namespace palpate
