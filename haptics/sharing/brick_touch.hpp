// Hands on a cloud of which only the bricks around them are loaded: they feel and sculpt only where points are known.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/background_task.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_stream.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/touch_statistics.hpp"
#include "haptics/session/far_touch.hpp"
#include "haptics/sharing/brick_source.hpp"

namespace palpate {

/// Sculpts a cloud of which only the bricks around the hands are loaded, where an answer says that the surface yields,
/// on a thread of its own: one edit at a time, of the points around the brush. Uses the code that edits a whole cloud
/// on the CPU (CpuSculpture), so the results are bitwise identical. No points are added; only carving removes points.
class BrickSculptor {
 public:
  /// `radius`: support radius, model units. `origin`: of the cloud, in the poses' coordinates. `source` must outlive
  /// it.
  BrickSculptor(BrickSource& source, double radius, const DVec3& origin);

  /// Sets the brush, or none.
  void setBrush(const std::optional<BrushOptions>& brush);
  bool hasBrush() const { return brush_.has_value(); }
  /// Takes an answer. `felt_s`: time of the frame that it was felt in. Against the clock a frame that does not contain
  /// the last edit triggers no further edit, and the call does not wait. Allocates nothing.
  void editIfYielding(const Contact& contact, const Pose& pose, double felt_s, bool realtime);
  /// The hand was repositioned.
  void lift() { stroke_.lift(); }
  void awaitRelease() { stroke_.awaitRelease(); }
  /// The hand has stopped: completes the remaining path of the stroke and ends it. Throws the error of a failed edit.
  void finish();

  const TouchStatistics& statistics() const { return statistics_; }
  /// Number of point changes by edits; a point counts each time.
  std::uint64_t states() const { return states_; }
  /// Points were changed by other means: the next edit waits until a frame of that version is felt. After finish().
  void setVersion(std::uint64_t version) { work_.version = version; }
  /// Number of distinct points changed by edits. After finish().
  std::size_t points() const { return work_.ever.size(); }

 private:
  bool finishedWithin(double budget_us);
  void start(double time_s, bool realtime);
  void edit();
  void measureSpacings(CpuSculpture& sculpture);

  BrickSource& source_;
  double radius_;
  DVec3 origin_;
  std::optional<BrushOptions> brush_;
  BrushStroke stroke_;
  TouchStatistics statistics_;
  EditPace pace_;
  bool isUnderWay_ = false;
  double time_s_ = 0;  // of the pose whose answer triggered the last edit
  std::uint64_t states_ = 0;
  // The thread's working data; only the thread accesses it while an edit runs.
  struct Work {
    std::optional<PlacedBrush> brush;
    SurfaceMeasure measure;
    Backlog backlog;
    // By the number of the point: what the stroke keeps of it, and spacings as loaded, model units.
    std::unordered_map<std::uint32_t, CpuSculpture::Kept> kept;
    std::unordered_map<std::uint32_t, float> spacings;
    std::uint32_t stroke = 0;
    double time_us = 0;
    std::uint64_t version = 0;  // version of the bricks that contains the last edit
    std::vector<PointState> points;
    std::vector<PointChange> changes;
    std::unordered_set<std::uint32_t> ever;  // points that were changed
  };
  Work work_;
  std::unique_ptr<BackgroundTask> task_;  // destroyed first
};

struct BrickTouchOptions {
  double radius = 0;                       ///< support radius of the surface, model units
  double widening = 1;                     ///< factor on the radius for noisy points; edits use the unwidened radius
  double tool = 0;                         ///< distance from a hand to the farthest point of its tool
  DVec3 origin{0};                         ///< of the cloud
  double timeout_s = 10;                   ///< timeout of virtual time, which waits for unknown points
  std::optional<BrushOptions> brush = {};  ///< of the first hand
  std::string fixed = {};                  ///< error text if the points cannot be sculpted; empty: they can
};

/// Wraps the back end that feels the points of a BrickSource, and sculpts them: it sends the source the positions of
/// the hands, and passes an answer on only if all points that it may depend on are known. Elsewhere the hand feels
/// nothing, its tick counts as one without data, and the hand is reset when points are known again. Against the clock
/// no tick waits; in virtual time each tick waits for its points, so that it is answered as if the whole cloud were
/// loaded.
/// Its edits are those of the hands here, undone ones included; points of others are in them where a hand here has
/// edited the same ones.
class BrickTouch final : public FarTouch, public EditStream {
 public:
  /// `surface` feels the points of `source`, which must outlive it.
  BrickTouch(BrickSource& source, std::unique_ptr<TouchBackend> surface, const BrickTouchOptions& options);

  UnknownTicks counts() const noexcept override { return {.ticks = ticks_.load(), .without = without_.load()}; }
  bool awaitAt(double time_s, std::span<const DVec3> hips, double timeout_s) override;

  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  /// Throws Error if virtual time ran into its timeout.
  void finish() override;
  /// Reads back only the loaded points, with their numbers as a field unless they move; returns the number of all
  /// points that a hand here has changed.
  std::size_t readBack(PointCloud& cloud) const override;
  /// Throws UsageError if the points cannot be sculpted.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void awaitRelease() override { sculptor_.awaitRelease(); }
  EditStream* edits() noexcept override { return options_.fixed.empty() && !source_.moves() ? this : nullptr; }
  BackendReport report() const override;

  void keep() override { source_.keepEdits(); }
  void take(EditBatch& batch) override { source_.takeEdits(batch); }
  EditProgress progress() const noexcept override { return {.states = sculptor_.states(), .dropped = 0}; }
  /// Points that others have changed stay as they are, which take() reports, now or when it is known here.
  void change(std::span<const PointChange> changes) override;
  /// Edits of others are received with the bricks.
  bool offer(std::span<const PointChange>, std::uint64_t) override { return false; }
  std::size_t mostOffered() const override { return 0; }

 private:
  struct Hand {
    std::optional<DVec3> hip, proxy;   // at the last tick with known points
    std::vector<PointContact> points;  // as returned by points()
  };
  HandReach reachOf(std::size_t hand, const DVec3& hip, double around) const;
  void tell(double time_s, std::span<const Pose> poses);
  void answer(std::size_t hand, const Pose& pose, const Contact& felt, bool late);
  void sculpt(const Pose& pose, bool realtime) noexcept;

  BrickSource& source_;
  BrickTouchOptions options_;
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  HandReaches asked_;
  BrickSculptor sculptor_;
  bool inVain_ = false;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> ticks_ = 0, without_ = 0;
};

}  // namespace palpate
