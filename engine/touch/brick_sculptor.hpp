#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/background_task.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/touch_statistics.hpp"

namespace palpate {

/// Sculpts a cloud of which only the bricks around the hands are here, where an answer says that the surface yields, on
/// a thread of its own: one edit at a time, of the points around the brush, by the text that edits a whole cloud on the
/// CPU (CpuSculpture), so that they become what they would there, bit by bit. Points neither come nor go but by
/// carving.
class BrickSculptor {
 public:
  /// `radius`: support radius, model units. `origin`: of the cloud, in the poses' coordinates. `source` outlives it.
  BrickSculptor(BrickSource& source, double radius, const DVec3& origin);

  /// Another brush from now on, or none.
  void setBrush(const std::optional<BrushOptions>& brush);
  bool hasBrush() const { return brush_.has_value(); }
  /// An answer. `felt_s`: of the frame that it was felt in. Against the clock a frame in which the last edit is not
  /// felt yet is no reason for another one, and nobody waits. Allocates nothing.
  void editIfYielding(const Contact& contact, const Pose& pose, double felt_s, bool realtime);
  /// The hand is put down elsewhere.
  void lift() { stroke_.lift(); }
  /// The hand has stopped: the stroke goes what is left of its way, and is over. Throws what went wrong.
  void finish();

  const TouchStatistics& statistics() const { return statistics_; }
  /// Points that edits have changed, each time that one did.
  std::uint64_t states() const { return states_; }
  /// Points that any edit has changed. After finish().
  std::size_t points() const { return work_.ever.size(); }

 private:
  bool finishedWithin(double budget_us);
  void start(double time_s, bool realtime);
  void edit();

  BrickSource& source_;
  double radius_;
  DVec3 origin_;
  std::optional<BrushOptions> brush_;
  BrushStroke stroke_;
  TouchStatistics statistics_;
  EditPace pace_;
  bool isUnderWay_ = false;
  double time_s_ = 0;  // of the pose whose answer led to the last edit
  std::uint64_t states_ = 0;
  // What the thread works with, which is its alone while it does.
  struct Work {
    std::optional<PlacedBrush> brush;
    SurfaceMeasure measure;
    std::unordered_map<std::uint32_t, SculptedPoints::Found> founds;  // by the number of the point
    std::uint32_t stroke = 0;
    double time_us = 0;
    std::uint64_t version = 0;  // of the bricks with it
    std::vector<PointState> points;
    std::vector<PointChange> changes;
    std::unordered_set<std::uint32_t> ever;  // points that were changed
  };
  Work work_;
  std::unique_ptr<BackgroundTask> task_;  // goes first
};

}  // namespace palpate
