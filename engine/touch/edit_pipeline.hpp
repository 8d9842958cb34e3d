#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/index_options.hpp"
#include "engine/core/mirrored_stroke.hpp"
#include "engine/core/offered_changes.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/touch/blocked_count.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/live_index.hpp"
#include "engine/touch/touch_statistics.hpp"

namespace palpate {

struct EditOptions {
  BrushOptions brush;
  double radius = 0;  ///< support radius, model units
  IndexFollow index = IndexFollow::incremental;
  CommandList::Timing timing = CommandList::Timing::sections;
  CompactionOptions compaction;
};

/// Edits the live cloud: brush edits where an answer says that the surface yields, offered changes, and given changes;
/// the index follows or is rebuilt. An edit is a command list recorded ahead, one for each half of the cloud and for
/// each sort that a build may need. One edit at a time is in progress; only the next question waits for it.
class EditPipeline {
 public:
  /// `colors`: as for EditPass. `index`, `log` and `statistics` must outlive it.
  EditPipeline(Device& device, const EditOptions& options, LiveIndex& index, EditLog& log, TouchStatistics& statistics,
               std::span<const std::uint32_t> colors);

  /// Records the edits for the front half of the cloud.
  void record();
  /// From now on the index follows edits. Call after record(), for both halves.
  void followIndex();
  /// Sets the brush, or none, while nothing is in progress; the edits of both halves are recorded again.
  void setBrush(const std::optional<BrushOptions>& brush);

  /// Takes each answer in order: the stroke continues, begins or ends. `origin`: of the cloud, in the pose's
  /// coordinates.
  void feel(const Contact& contact, const Pose& pose, const DVec3& origin);
  /// The hand was repositioned.
  void lift() { stroke_.lift(); }
  /// As TouchBackend::awaitRelease().
  void awaitRelease() { stroke_.awaitRelease(); }
  /// As if the hand had not sculpted before. After finish().
  void restart() { stroke_.restart(); }
  /// Submits an edit if the stroke acts or the last edit left work, and nothing prevents it. In virtual time the edit
  /// is complete on return. True: points have moved, or will.
  bool editIfYielding(double time_s, bool realtime);
  /// Submits the offered changes (EditStream::offer()), if any, for a pose of this time; only while no edit is in
  /// progress and all earlier entries are published. In virtual time they are complete and published on return. True:
  /// points have moved, or will.
  bool takeUpOffer(double time_s, bool realtime);
  /// Whether the last submission was an offer, not a brush edit.
  bool lastWasOffer() const { return lastWasOffer_; }
  /// Publishes the collected entries to the log: all entries before `head` (EditLog).
  void publish(std::uint32_t head);
  /// Collects the edit in progress, and a compaction that is ending, once a later submission to the same queue has
  /// answered. `sinceAsked`: time since that question, if the driver is not asked for times; otherwise null.
  void collect(const Stopwatch* sinceAsked);
  /// The hand has stopped: completes the remaining path of the stroke and ends it. Publishes all edits.
  void finish();
  /// As EditStream::change(). Waits.
  void change(std::span<const PointChange> changes);
  /// As EditStream::replace(). Waits.
  void replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without);
  /// As EditStream::lock(). While nothing is in progress.
  void lock(const PointLock& lock) { pass_.lock(lock); }
  /// As TouchBackend::readBack().
  std::size_t readBack(PointCloud& cloud) const;

  OfferedChanges& offered() { return offered_; }
  const OfferedChanges& offered() const { return offered_; }
  bool isUnderWay() const { return last_.isUnderWay || offer_.isUnderWay; }
  /// Whether something is in progress, or waits for the next answer.
  bool hasWork() const { return isUnderWay() || offered_.isThere() || index_.isCompacting(); }
  const EditPass& pass() const { return pass_; }
  BlockedMoves blocked() const noexcept { return blocked_.sum(); }  ///< EditStream::blocked()
  /// Passes of the last edit; before any edit, of the next one.
  std::vector<PassRecord> passes() const { return (last_.list ? *last_.list : chosen()).passes(); }

 private:
  // For one half of the cloud.
  struct Lists {
    std::map<std::pair<SortMethod, EditPass::Reach>, std::unique_ptr<CommandList>> rebuilds;
    std::map<EditPass::Reach, std::unique_ptr<CommandList>> incremental;
  };
  struct LastEdit {
    const CommandList* list = nullptr;  // null: none since the lists were recorded
    Queue::Ticket ticket = 0;
    bool isUnderWay = false;
    Stopwatch since;
    double time_s = 0;  // of the pose whose answer triggered it
  };
  // An offer being applied.
  struct TakenOffer {
    std::unique_ptr<CommandList> list;  // recorded again for each; null: no offers are accepted
    Queue::Ticket ticket = 0;
    bool isUnderWay = false, rebuilds = false;
    bool isDone = false;     // done but not published yet
    bool hasFailed = false;  // the index could not follow: retried with a full build
    Stopwatch since;
    double time_s = 0;
  };
  // Consequences of the last edit for the next one.
  struct Next {
    bool large = false;  // too large for an index update
    bool all = false;    // and for a box
  };
  EditPass::Reach reach() const { return next_.all ? EditPass::Reach::all : pass_.reach(); }
  void markStroke();
  const CommandList& chosen() const;
  bool updates(const CommandList& list) const;
  void submit(const CommandList& list, double time_s);
  // Waits for the edit in progress; repeats a failed one with a full build.
  void settle();
  void takeReport();
  void submitOffer(double time_s);
  void collectOffer(const Stopwatch* sinceAsked);
  std::uint32_t logHead() const;
  void compact();
  // Returns why it failed: shared::kUpdate...
  std::uint32_t changeBatch(std::span<const PointChange> changes, EditPass::Given given);
  void revert(std::span<const PointChange> changes);

  Device& device_;
  EditOptions options_;
  LiveIndex& index_;
  EditLog& log_;
  TouchStatistics& statistics_;
  EditPass pass_;
  MirroredStroke stroke_;
  SurfaceMeasure measured_;  // sum over all edits so far
  BlockedCount blocked_;
  std::array<Lists, 2> lists_;
  // Kept, since an allocation takes far longer than the copy of the head.
  Buffer head_;
  CommandList readsHead_;
  LastEdit last_;
  Next next_;
  OfferedChanges offered_;
  TakenOffer offer_;
  std::uint64_t changes_ = 0;  // calls of change() reported so far
  EditPace pace_;
  bool brushOn_ = true, inStroke_ = false, lastWasOffer_ = false;
  std::uint32_t strokeMarked_ = 0;  // number of the stroke that edits belong to
};

}  // namespace palpate
