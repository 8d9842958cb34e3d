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
#include "engine/core/offered_changes.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
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

/// Edits the live cloud: the brush where an answer says that the surface yields, the index that follows or is built
/// anew, changes that somebody offers, and others as they are given. An edit is a command list recorded ahead, one for
/// each half of the cloud, and for each sort that a build may need. One at a time is under way, and nobody waits for it
/// but the next question.
class EditPipeline {
 public:
  /// `colors` as EditPass has them. `index`, `log` and `statistics` must outlive it.
  EditPipeline(Device& device, const EditOptions& options, LiveIndex& index, EditLog& log, TouchStatistics& statistics,
               std::span<const std::uint32_t> colors);

  /// Records the edits for the half of the cloud that counts now.
  void record();
  /// From now on the index follows. After record(), for both halves.
  void followIndex();
  /// Another brush from now on, or none, while nothing is under way; the edits of both halves are recorded again.
  void setBrush(const std::optional<BrushOptions>& brush);

  /// The answer to a pose, one after another: the stroke goes on with it, begins or ends. `origin`: of the cloud, in
  /// the pose's coordinates.
  void feel(const Contact& contact, const Pose& pose, const DVec3& origin);
  /// The hand is put down elsewhere.
  void lift() { stroke_.lift(); }
  /// Submits an edit when the stroke has something to do, or when the last edit left something, and nothing stands in
  /// its way. In virtual time it is done when it returns. True: points have moved, or will.
  bool editIfYielding(double time_s, bool realtime);
  /// Submits what is offered (TouchBackend::offer()), if anything is, for a pose of this time; while no edit is under
  /// way, and once all that came before is published. In virtual time it is done, and published, when it returns. True:
  /// points have moved, or will.
  bool takeUpOffer(double time_s, bool realtime);
  /// Whether an offer was submitted last, and no brush's edit since.
  bool lastWasOffer() const { return lastWasOffer_; }
  /// Publishes to the log what has been collected: all entries before `head` (EditLog).
  void publish(std::uint32_t head);
  /// Takes note of the edit under way, and of a compaction that comes to its end, once a later submission to the same
  /// queue has answered. `sinceAsked`: of that question, where the driver is not asked for times; null where it is.
  void collect(const Stopwatch* sinceAsked);
  /// The hand has stopped: the stroke goes what is left of its way, and is over. Publishes all that was done.
  void finish();
  /// As TouchBackend::change(). Waits.
  void change(std::span<const PointChange> changes);
  /// As TouchBackend::readBack().
  std::size_t readBack(PointCloud& cloud) const;

  OfferedChanges& offered() { return offered_; }
  const OfferedChanges& offered() const { return offered_; }
  bool isUnderWay() const { return last_.isUnderWay || offer_.isUnderWay; }
  const EditPass& pass() const { return pass_; }
  /// The passes of the last edit, or of the next one where there was none.
  std::vector<PassRecord> passes() const { return (last_.list ? *last_.list : chosen()).passes(); }

 private:
  // Of one half of the cloud.
  struct Lists {
    std::map<std::pair<SortMethod, EditPass::Reach>, std::unique_ptr<CommandList>> rebuilds;
    std::map<EditPass::Reach, std::unique_ptr<CommandList>> incremental;
  };
  struct LastEdit {
    const CommandList* list = nullptr;  // none since the lists were recorded
    Queue::Ticket ticket = 0;
    bool isUnderWay = false;
    Stopwatch since;
    double time_s = 0;  // of the pose whose answer led to it
  };
  // An offer that is carried out.
  struct TakenOffer {
    std::unique_ptr<CommandList> list;
    Queue::Ticket ticket = 0;
    bool isUnderWay = false, rebuilds = false;
    bool isDone = false;     // and not published yet
    bool hasFailed = false;  // the index could not follow: it goes again, with a full build
    Stopwatch since;
    double time_s = 0;
  };
  // What the last edit came to means for the next one.
  struct Next {
    bool large = false;  // too large for an update
    bool all = false;    // and for a box
  };
  EditPass::Reach reach() const { return next_.all ? EditPass::Reach::all : pass_.reach(); }
  void markStroke();
  const CommandList& chosen() const;
  bool updates(const CommandList& list) const;
  void submit(const CommandList& list, double time_s);
  // Waits for the edit under way; one that did not come out is done again with a full build.
  void settle();
  void takeReport();
  void submitOffer(double time_s);
  void collectOffer(const Stopwatch* sinceAsked);
  std::uint32_t logHead() const;
  void compact();
  void changeBatch(std::span<const PointChange> changes);

  Device& device_;
  EditOptions options_;
  LiveIndex& index_;
  EditLog& log_;
  TouchStatistics& statistics_;
  EditPass pass_;
  BrushStroke stroke_;
  SurfaceMeasure measured_;  // by all edits so far
  std::array<Lists, 2> lists_;
  LastEdit last_;
  Next next_;
  OfferedChanges offered_;
  TakenOffer offer_;
  std::uint64_t changes_ = 0;  // calls of change() that were reported
  EditPace pace_;
  bool brushOn_ = true, inStroke_ = false, lastWasOffer_ = false;
  std::uint32_t strokeMarked_ = 0;  // the one that edits belong to
};

}  // namespace palpate
