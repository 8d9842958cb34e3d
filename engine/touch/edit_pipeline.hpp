#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/index_options.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/contact_query.hpp"
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
/// anew, and changes as they are given. An edit is a command list recorded ahead, one for each half of the cloud, and
/// for each sort that a build may need. One at a time is under way, and nobody waits for it but the next question.
class EditPipeline {
 public:
  /// `colors` as EditPass has them. `index`, `log` and `statistics` must outlive it.
  EditPipeline(Device& device, const EditOptions& options, LiveIndex& index, EditLog& log, TouchStatistics& statistics,
               std::span<const std::uint32_t> colors);

  /// Records the edits for the half of the cloud that counts now; for the tick's contact state.
  void record(const Buffer& contactState);
  /// From now on the index follows. After record(), for both halves.
  void followIndex();
  /// Another brush from now on, or none, while nothing is under way; the edits of both halves are recorded again.
  void setBrush(const std::optional<BrushOptions>& brush, const Buffer& contactState);

  /// Submits an edit when the answer to the HIP says that the surface yields, or when the last edit left something to
  /// do, and nothing stands in its way. In virtual time it is done when it returns. True: points have moved, or will.
  bool editIfYielding(const Contact& contact, const Pose& pose, bool realtime);
  /// Takes note of the edit under way, and of a compaction that comes to its end, once a later submission to the same
  /// queue has answered. `sinceAsked`: of that question, where the driver is not asked for times; null where it is.
  void collect(const Stopwatch* sinceAsked);
  /// The stroke is over, unless it goes on by itself.
  void rest();
  void endStroke();
  /// As TouchBackend::change(). Waits.
  void change(std::span<const PointChange> changes);
  /// As TouchBackend::readBack().
  std::size_t readBack(PointCloud& cloud) const;

  bool isUnderWay() const { return last_.isUnderWay; }
  const EditPass& pass() const { return pass_; }
  /// The passes of the last edit, or of the next one where there was none.
  std::vector<PassRecord> passes() const { return (last_.list ? *last_.list : chosen()).passes(); }

 private:
  // Of one half of the cloud.
  struct Lists {
    std::map<std::pair<SortMethod, EditPass::Reach>, std::unique_ptr<CommandList>> rebuilds;
    std::unique_ptr<CommandList> incremental;
  };
  struct LastEdit {
    const CommandList* list = nullptr;  // none since the lists were recorded
    Queue::Ticket ticket = 0;
    bool isUnderWay = false;
    Stopwatch since;
    double time_s = 0;  // of the pose whose answer led to it
  };
  // What the last edit came to means for the next one.
  struct Next {
    bool large = false;                            // too large for an update
    EditPass::Reach reach = EditPass::Reach::box;  // with a build
  };
  const CommandList& chosen() const;
  bool updates(const CommandList& list) const;
  void submit(const CommandList& list, double time_s);
  // Waits for the edit under way; one that did not come out is done again with a full build.
  void settle();
  void takeReport();
  void compact();
  void changeBatch(std::span<const PointChange> changes);

  Device& device_;
  EditOptions options_;
  LiveIndex& index_;
  EditLog& log_;
  TouchStatistics& statistics_;
  EditPass pass_;
  std::array<Lists, 2> lists_;
  LastEdit last_;
  Next next_;
  EditPace pace_;
  bool brushOn_ = true, inStroke_ = false;
};

}  // namespace palpate
