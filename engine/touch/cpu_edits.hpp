#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/background_task.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_queue.hpp"
#include "engine/core/mirrored_stroke.hpp"
#include "engine/core/offered_changes.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/blocked_count.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/touch_backend.hpp"
#include "engine/touch/touch_statistics.hpp"

namespace palpate {

/// Edits points on a thread of its own, one edit at a time: brush edits where an answer says that the surface yields,
/// offered changes, and given changes. Only the next answer waits for an edit. While an edit is in progress only that
/// thread accesses the sculpture.
class CpuEdits {
 public:
  struct Setting {
    double radius = 0;             ///< support radius, model units
    DVec3 origin{0};               ///< of the cloud, in the poses' coordinates
    std::optional<EditSize> size;  ///< default: whole in virtual time, a tick's in real time
    std::uint64_t room = 0;        ///< states that the followers may be behind; 0: kEditRoom, or four times all points
  };
  /// Without a brush there is no thread. `sculpture` must outlive it.
  CpuEdits(CpuSculpture& sculpture, const std::optional<BrushOptions>& brush, const Setting& setting);

  bool hasThread() const { return task_ != nullptr; }
  /// Sets the brush, or none, while nothing is in progress.
  void setBrush(const std::optional<BrushOptions>& brush);
  /// Takes each answer in order: the stroke continues, begins or ends. While nothing is in progress.
  void feel(const Contact& contact, const Pose& pose);
  /// The hand was repositioned.
  void lift() { stroke_.lift(); }
  /// As TouchBackend::awaitRelease().
  void awaitRelease() { stroke_.awaitRelease(); }
  /// As if the hand had not sculpted before. After finish().
  void restart() { stroke_.restart(); }
  /// Begins an edit if the stroke acts or the last edit left work. True: it has begun.
  bool editIfYielding(double time_s, bool realtime);
  /// Begins to apply the offered changes (EditStream::offer()), if any, for a pose of this time.
  bool takeUpOffer(double time_s, bool realtime);
  /// The thread starts to work on what has begun; until then the points are as they were.
  void start();
  /// An edit has begun that the thread has not started.
  bool isBegun() const { return isBegun_; }
  bool isUnderWay() const { return isUnderWay_; }
  /// Differs after every edit and change.
  std::uint64_t version() const { return version_; }
  /// Whether the last edit was an offer, not a brush edit. While nothing is in progress.
  bool lastWasOffer() const { return work_.isOffer; }
  /// Whether no edit is in progress, within the budget (0: no limit). Starts what has begun; collects the completed
  /// edit.
  bool finishedWithin(double budget_us);
  /// Waits for the edit in progress without collecting it.
  void wait() const;
  /// The hand has stopped: completes the remaining path of the stroke and ends it.
  void finish();
  /// As EditStream::change(), at `time_s`, while nothing is in progress. Throws Error.
  void change(std::span<const PointChange> changes, double time_s);

  /// As EditStream::replace(), while nothing is in progress.
  void replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without);
  /// As EditStream::lock(), while nothing is in progress.
  void lock(const PointLock& lock) { sculpture_.lock(lock); }

  EditQueue& queue() { return queue_; }
  const EditQueue& queue() const { return queue_; }
  OfferedChanges& offered() { return offered_; }
  const OfferedChanges& offered() const { return offered_; }
  /// EditStream::progress.
  std::uint64_t answered() const { return answered_; }
  /// The sculpture's state after the last completed edit, for reports while the next one is in progress.
  struct Collected {
    std::uint32_t touched = 0;  ///< points that the last brush edit changed, moved or removed
    IndexWork index;
    BackendMemory memory;
  };
  const Collected& collected() const { return collected_; }
  BlockedMoves blocked() const noexcept { return blocked_.sum(); }  ///< EditStream::blocked()
  const TouchStatistics& statistics() const { return statistics_; }

 private:
  // The thread's working data; only the thread accesses it while an edit runs.
  struct Work {
    std::optional<PlacedBrush> brush;
    EditSize size = EditSize::whole;
    bool isOffer = false, inStroke = false;  // isOffer: applies the offered changes instead of the brush
    double time_us = 0;                      // of the last edit
    std::uint64_t states = 0;                // appended to the queue so far
  };
  void begin(double time_s, bool realtime);
  void begin();
  void edit();
  void carryOut();
  void collect();
  void markStroke();

  CpuSculpture& sculpture_;
  std::optional<BrushOptions> brush_;
  Setting setting_;
  MirroredStroke stroke_;
  Work work_;
  bool isUnderWay_ = false, isBegun_ = false, inStroke_ = false;
  std::uint64_t version_ = 0;
  std::uint32_t strokeMarked_ = 0;  // number of the stroke that edits belong to
  double time_s_ = 0;               // of the pose whose answer triggered the last edit
  std::uint64_t answered_ = 0;
  Collected collected_;
  BlockedCount blocked_;
  std::uint64_t changes_ = 0;  // calls of change() reported so far
  EditPace pace_;
  WorkPace workPace_;
  TouchStatistics statistics_;
  EditQueue queue_;
  OfferedChanges offered_;
  std::vector<PointChange> standing_;     // applicable changes of an offer; used by the thread
  std::unique_ptr<BackgroundTask> task_;  // destroyed first
};

}  // namespace palpate
