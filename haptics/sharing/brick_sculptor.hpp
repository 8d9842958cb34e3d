#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/background_task.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/touch_statistics.hpp"
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

}  // namespace palpate
