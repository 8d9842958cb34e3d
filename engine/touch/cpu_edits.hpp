#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/background_task.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_queue.hpp"
#include "engine/core/offered_changes.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/touch_statistics.hpp"

namespace palpate {

/// Edits points on a thread of its own, one edit at a time: the brush where an answer says that the surface yields,
/// changes that somebody offers, and others as they are given. Nobody waits for it but the next answer. While an edit
/// is under way the sculpture is that thread's alone.
class CpuEdits {
 public:
  /// Without a brush there is no thread. `radius`: support radius, model units. `origin`: of the cloud, in the poses'
  /// coordinates. `sculpture` must outlive it.
  CpuEdits(CpuSculpture& sculpture, const std::optional<BrushOptions>& brush, double radius, const DVec3& origin);

  bool hasThread() const { return task_ != nullptr; }
  /// Another brush from now on, or none, while nothing is under way.
  void setBrush(const std::optional<BrushOptions>& brush);
  /// The answer to a pose, one after another: the stroke goes on with it, begins or ends. While nothing is under way.
  void feel(const Contact& contact, const Pose& pose);
  /// The hand is put down elsewhere.
  void lift() { stroke_.lift(); }
  /// Starts an edit when the stroke has something to do, or when the last edit left something. True: it has started.
  bool editIfYielding(double time_s, bool realtime);
  /// Starts to carry out what is offered (TouchBackend::offer()), if anything is, for a pose of this time.
  bool takeUpOffer(double time_s, bool realtime);
  /// Whether an offer was carried out last, and no brush has edited since. While nothing is under way.
  bool lastWasOffer() const { return work_.isOffer; }
  /// Whether none is under way, within the budget (0: as long as it takes). Takes note of the one that has ended.
  bool finishedWithin(double budget_us);
  /// Waits for the one that is under way, and takes no note.
  void wait() const;
  /// The hand has stopped: the stroke goes what is left of its way, and is over.
  void finish();
  /// As TouchBackend::change(), at `time_s`, while nothing is under way.
  void change(std::span<const PointChange> changes, double time_s);

  EditQueue& queue() { return queue_; }
  OfferedChanges& offered() { return offered_; }
  const OfferedChanges& offered() const { return offered_; }
  /// TouchBackend::editsAnswered.
  std::uint64_t answered() const { return answered_; }
  const TouchStatistics& statistics() const { return statistics_; }

 private:
  // What the thread works with, which is its alone while it does.
  struct Work {
    std::optional<PlacedBrush> brush;
    bool isOffer = false, inStroke = false;  // carries out what is offered in place of the brush
    double time_us = 0;                      // of the edit that ran last
    std::uint64_t states = 0;                // in the queue so far
  };
  void edit();
  void carryOut();
  void report(std::size_t count, bool inStroke);
  void markStroke();

  CpuSculpture& sculpture_;
  std::optional<BrushOptions> brush_;
  double radius_;
  DVec3 origin_;
  BrushStroke stroke_;
  Work work_;
  bool isUnderWay_ = false, inStroke_ = false;
  std::uint32_t strokeMarked_ = 0;  // the one that edits belong to
  double time_s_ = 0;               // of the pose whose answer led to the last edit
  std::uint64_t answered_ = 0;
  std::uint64_t changes_ = 0;  // calls of change() that were reported
  EditPace pace_;
  TouchStatistics statistics_;
  EditQueue queue_;
  OfferedChanges offered_;
  std::vector<PointChange> standing_;     // what of an offer is carried out; the thread's
  std::unique_ptr<BackgroundTask> task_;  // goes first
};

}  // namespace palpate
