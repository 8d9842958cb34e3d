#pragma once

#include <array>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "engine/contact/contact_step.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/edit/edit_fetch.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/spatial/hash_compaction.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/patch_bridge.hpp"
#include "engine/touch/second_contact.hpp"
#include "engine/touch/tool_contacts.hpp"

namespace palpate {

/// How the index follows an edit: at the cost of what the edit touched, as long as that is less than building it anew;
/// or built anew each time.
enum class IndexFollow { incremental, rebuild };

struct TouchOptions {
  double radius = 0;  ///< support radius, model units
  double cell = 0;    ///< edge of a hash cell, model units; 0: the support radius
  BucketKey bucketKey = BucketKey::teschner;
  SortMethod sort = kDefaultSort;                 ///< of the index
  BucketOrder bucketOrder = BucketOrder::stable;  ///< stable: the same poses give the same answers, bit by bit
  QueryMethod method = QueryMethod::fused;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;           ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;                ///< of the support radius, where the surface is flat; edits are narrow
  double friction = 0;                ///< coefficient, of a proxy that slides
  std::optional<bool> split;          ///< fused: whether a few workgroups share a gather (ContactOptions)
  ToolShape tool;                     ///< what touches, model units; with points only fused, and not ahead
  bool secondHand = false;            ///< is felt for as well (Pose::secondHip); only fused, and not ahead
  std::optional<BrushOptions> brush;  ///< edit while touching, where the HIP itself does
  bool paintable = false;             ///< keeps colours, for a brush that comes later
  IndexFollow index = IndexFollow::incremental;
  std::optional<std::uint32_t>
      spareSlots;  ///< where the index follows edits; in proportion to the cloud when not given
  CompactionOptions compaction;
  std::optional<Wait> wait;   ///< how the servo thread waits for the GPU; the device's default when not given
  std::optional<bool> ahead;  ///< submit each question before its pose is known (TouchSide); where not given, on
                              ///< drivers that are known to let it wait, if it does
  CommandList::Timing timing = CommandList::Timing::sections;
};

/// The touch side: owns the live cloud and its index, and answers each pose with one small command buffer recorded
/// ahead (pose, gather, surface, proxy, answer); two where the query method brings the host in between. When the answer
/// says that the surface yields, a second one is submitted that edits the points and brings the index up to date;
/// nobody waits for it but the next tick's query. While a question is out past its tick's budget, ticks are answered on
/// the CPU from the patch of points that the GPU brought last.
///
/// Submitting takes longer than answering. So prepare() can submit the next question ahead: it waits on the GPU until
/// the host has written the pose into its memory, which also keeps the GPU awake between ticks. A question for which no
/// pose comes in time ends by itself, and the next pose is asked for in the ordinary way.
///
/// A tool of many points is one question with a probe for each of them, and one for the HIP itself, where the brush
/// works; all are answered by one dispatch. While its answer is late, the patch answers for the points that it reaches,
/// each with a proxy that goes on from the GPU's, and the others keep the tangent plane that they felt last
/// (heldContact). A second hand is one more probe of the same dispatch; the patch, which is where the first one is,
/// does not reach it, and it keeps its plane.
class TouchSide final : public TouchBackend {
 public:
  /// `cloud` must have normals. Uploads it and builds the index. Throws OutOfGpuMemory before anything is uploaded when
  /// the cloud cannot fit.
  TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options);
  ~TouchSide() override;

  /// When the GPU is late, the last patch answers (PatchBridge), and `fresh` says so.
  Contact query(const Pose& pose, double budget_us) noexcept override;
  void prepare() noexcept override;
  std::span<const PointContact> points() const noexcept override;
  void beginAnew() noexcept override;
  Contact second() const noexcept override { return second_ ? second_->told() : Contact{}; }
  void secondBeginsAnew() noexcept override;
  /// Also publishes the last edit to the log.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;

  bool keepsEdits() const override { return true; }
  void keepEdits() override { fetch_.emplace(device_, log_); }
  void takeEdits(EditBatch& batch) override { fetch_->take(batch); }
  void change(std::span<const PointChange> changes) override;
  void setBrush(const std::optional<BrushOptions>& brush) override;
  /// Another surface, friction or query method from now on; the next pose begins anew. For the thread that queries,
  /// between queries.
  void setContact(SurfaceKind surface, double friction, QueryMethod method);
  std::uint64_t editsAnswered() const override { return editsAnswered_; }

  EditLog& editLog() { return log_; }
  const LiveCloud& live() const { return live_; }
  bool paints() const { return options_.brush && (options_.paintable || options_.brush->kind == BrushKind::paint); }
  const SpatialHash& hash() const { return hash_; }
  const ContactStep& contact() const { return contact_; }
  /// Null where no points are edited.
  const EditPass* edits() const { return edit_ ? &*edit_ : nullptr; }
  /// Full builds of the index that edits and changes took.
  std::uint64_t fullBuilds() const { return fullBuilds_; }
  std::string machine() const override { return device_.name(); }
  double buildTime_us() const override { return buildTime_us_; }
  const std::vector<double>& editTimes_us() const override { return editTimes_us_; }
  /// For each of these edits what it took then to find where points should come and go with the next one; 0 where the
  /// edit's time includes it.
  const std::vector<double>& wishTimes_us() const { return wishTimes_us_; }
  std::optional<double> firstEditTime_s() const override { return firstEditTime_s_; }
  const TouchShortfalls& shortfalls() const override { return shortfalls_; }
  /// Whether questions are submitted ahead of their poses.
  bool asksAhead() const { return ahead_; }
  /// How many were answered that way.
  std::uint64_t answeredAhead() const { return answeredAhead_; }
  std::span<const double> bridgeTimes_us() const override { return bridge_->answerTimes_us(); }
  std::uint64_t compactions() const override { return compactions_; }
  IndexWork indexWork() const override { return {.followed = followed_, .built = fullBuilds_}; }
  bool isCompacting() const { return compaction_ && !compaction_->isIdle(); }
  /// The longest time that touch had to wait for the end of a compaction, us: its time on the GPU; where a driver is
  /// not asked for times, that of the question which stood behind it, from then until its answer was seen.
  double longestCompactionEnd_us() const { return longestCompactionEnd_us_; }
  double cell() const override { return 1.0 / static_cast<double>(hash_.grid().inverseCell); }
  /// The passes of a tick in order, edit included, with their last times.
  std::vector<PassRecord> passes() const;

 private:
  // The lists of queries_[parity] that a question ran or runs, from `first` to `last`.
  struct Run {
    std::uint32_t parity = 0, first = 0, last = 0;
  };
  // A question that is out: the last list of its run was submitted.
  struct Asked {
    Pose pose;
    Run run = {};
    Queue::Ticket ticket = 0;
    bool behindEdit = false;     // an edit was still under way
    bool dropped = false;        // touch has begun anew since
    bool secondDropped = false;  // that of the second hand has
    bool timed = true;           // on the GPU; a driver that needs our cores may wait for all its work to tell a time
    double gpu_us = 0;           // of the lists that have run
  };
  // What an answer leads to: in virtual time with it, in real time once its force is out.
  void closeTick();
  // Submits the next question ahead, if it may be.
  void askAhead();
  // Ends a question that was submitted ahead.
  void withdraw();
  // Whether a question that was submitted ahead hears what the host writes then.
  bool hearsTheHost();
  // Has the driver do once what it would else do in mid-touch.
  void warmUp();
  // Whether the last question's list has ended, as the driver sees it: some us after its answer was seen.
  bool mayAskWithin(double budget_us) const;
  void ask(const Pose& pose, bool realtime);
  // What the GPU has answered to a probe that was at `hip`.
  Contact contactOf(const shared::ContactSample& sample, const DVec3& hip, double time_us) const;
  // The last answer, and what stands for it in a tick that gets none.
  Contact told();
  Contact bridged(const Pose& pose);
  void forgetTool();
  // The probe of the second hand, after those of the first and its tool.
  std::uint32_t secondProbe() const { return 1 + static_cast<std::uint32_t>(options_.tool.points.size()); }
  // One hand is put down elsewhere; `forget` is what its probes know.
  void forgetBy(const CommandList& forget);
  void submitQuestion();
  // Waits until the last question's list may run again, and learns how long it took.
  void settleLast();
  const CommandList& lastList(const Run& run) const { return *queries_[run.parity][run.last]; }
  // Takes the answer into last_ when it comes within the budget (0: whenever it comes). `now_s`: of the present pose.
  bool answerWithin(double budget_us, double now_s);
  // Takes in the answer to an earlier tick's question. False while that is still out.
  bool lateAnswerIsIn(const Pose& pose, double budget_us);
  // Whether the list that was submitted last has done its part, as `wait_` looks at it (0: waits until it has).
  bool runEndsWithin(double budget_us);
  // All lists, for both sides of the cloud.
  void recordAll();
  // Waits for all that is under way.
  void settle();
  ContactOptions contactOptions() const;
  void makeBridge();
  void recordQuery(std::uint32_t parity);
  void recordEdits();
  void editIfYielding(bool realtime);
  const CommandList& chosenEdit() const;
  // Waits for the edit under way; one that did not come out is done again with a full build.
  void settleEdit();
  void submitEdit(const CommandList& edit);
  // Records, with the sort that a build needs, what reads one side of the cloud and writes the other; runs and flips.
  void runAndFlip(const std::function<void(CommandList&, SortMethod)>& record);
  void compact();
  // Compaction in the background: the next step of it, if it is due or under way; in virtual time all of it at once.
  void compactFurther(bool realtime);
  void collectCompaction(bool timed);
  void noteCompaction(bool completed, bool timed);
  // Whether a full build may write the other side of the cloud now: a compaction is given up for it, and in real time
  // it must come again while a slice is under way.
  bool mayBuild(bool realtime);
  void changeBatch(std::span<const PointChange> changes);
  // Takes note of what the last edit came to, for the next one.
  void takeReport();
  // Not timed: takes the time until now for the edit's.
  void collectEdit(bool timed);
  void endStroke();

  Device& device_;
  TouchOptions options_;
  Wait wait_;
  DVec3 origin_;
  LiveCloud live_;
  SpatialHash hash_;
  ContactStep contact_;
  EditLog log_;
  std::optional<EditFetch> fetch_;  // where somebody takes edits
  std::optional<EditPass> edit_;
  std::optional<HashCompaction> compaction_;  // where the index follows edits
  std::optional<PatchBridge> bridge_;
  std::optional<ToolContacts> tool_;  // of many points
  std::optional<SecondContact> second_;
  // What the patch has made of a point since the GPU's answer, or the story that this has left.
  struct ToolTracker {
    ProxyTracker tracker;
    bool ahead = false;  // the GPU does not know of it
  };
  std::vector<ToolTracker> toolTrackers_;
  CommandList forget_, forgetSecond_;  // what the contact step knows of the ticks before
  // One for each side of the live cloud; an edit with a build also for each sort that it may need.
  std::array<std::vector<std::unique_ptr<CommandList>>, 2> queries_;
  using Rebuild = std::pair<SortMethod, EditPass::Reach>;
  std::array<std::map<Rebuild, std::unique_ptr<CommandList>>, 2> rebuilds_;
  std::array<std::unique_ptr<CommandList>, 2> incrementals_;
  std::uint32_t tick_ = 0;
  bool ahead_ = false;
  std::uint64_t answeredAhead_ = 0;
  struct Waiting {
    Run run;
    Queue::Ticket ticket = 0;
  };
  std::optional<Waiting> waiting_;  // a question that was submitted ahead
  struct Open {
    Pose pose;
    bool realtime = false;
    bool answered = false;
  };
  std::optional<Open> open_;  // the last tick, until closeTick()
  std::optional<Asked> asked_;
  Stopwatch sinceAsked_;
  Contact last_;  // to the HIP itself
  Pose lastPose_;
  double buildTime_us_ = 0;
  bool editInFlight_ = false, inStroke_ = false;
  bool compactionDue_ = false;
  std::uint64_t compactions_ = 0;
  double longestCompactionEnd_us_ = 0;
  bool brushOn_ = true;
  bool largeEdits_ = false;                       // the next edit is too large for an update
  EditPass::Reach reach_ = EditPass::Reach::box;  // of the next edit with a build
  std::uint64_t editsAnswered_ = 0, fullBuilds_ = 0, followed_ = 0;
  Queue::Ticket editTicket_ = 0;
  Stopwatch sinceEdit_;
  std::optional<Queue::Ticket> ended_;  // of the last query that was answered
  double lastTime_us_ = 0;              // on the GPU, of its lists whose time is known
  std::vector<double> editTimes_us_, wishTimes_us_;
  EditPace pace_;
  double editTime_s_ = 0;  // of the pose whose answer led to the last edit
  Run lastQuery_;
  const CommandList* lastEdit_ = nullptr;
  TouchShortfalls shortfalls_;
  std::optional<double> firstEditTime_s_;
  std::exception_ptr failure_;
};

}  // namespace palpate
