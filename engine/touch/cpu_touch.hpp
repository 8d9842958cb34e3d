#pragma once

#include <exception>
#include <memory>
#include <optional>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/background_task.hpp"
#include "engine/core/edit_queue.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/edit/sculpt_reference.hpp"
#include "engine/touch/edit_pace.hpp"
#include "engine/touch/second_contact.hpp"
#include "engine/touch/tool_contacts.hpp"

namespace palpate {

struct CpuTouchOptions {
  double radius = 0;  ///< support radius, model units
  double cell = 0;    ///< edge of a grid cell, model units; 0: the support radius
  BucketKey bucketKey = BucketKey::teschner;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;           ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;                ///< of the support radius, where the surface is flat; edits are narrow
  double friction = 0;                ///< coefficient, of a proxy that slides
  ToolShape tool;                     ///< what touches, model units
  std::optional<BrushOptions> brush;  ///< edit while touching, where the HIP itself does
  unsigned threads = 0;               ///< that build the index and refit normals; 0: one per core
};

/// The whole loop on the CPU, in double precision: for machines without a GPU, and the peer that GPUs are held against.
/// The surface is evaluated wherever the proxy goes, straight from the index. When the surface yields, a thread of its
/// own edits the points and builds the index anew; nobody waits for it but the next tick's query. A tool of many points
/// is felt point by point, one after another, each with a proxy of its own; and so is a second hand.
class CpuTouch final : public TouchBackend, private SurfaceField {
 public:
  /// Copies what it needs of `cloud`, which must have normals, and builds the index.
  CpuTouch(const PointCloud& cloud, const CpuTouchOptions& options);

  /// While an edit outlasts the budget, the last answer is held (heldContact), and `fresh` says so. The query itself is
  /// not cut short: on an even cloud it takes some ten microseconds.
  Contact query(const Pose& pose, double budget_us) noexcept override;
  std::span<const PointContact> points() const noexcept override;
  void beginAnew() noexcept override;
  Contact second() const noexcept override { return second_.told(); }
  void secondBeginsAnew() noexcept override;
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;

  bool keepsEdits() const override { return true; }
  void keepEdits() override { queue_.keep(); }
  void takeEdits(EditBatch& batch) override { queue_.take(batch); }
  void change(std::span<const PointChange> changes) override;
  /// Density is kept where the first brush kept it.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  /// Another surface or friction from now on; the next pose begins anew. For the thread that queries, between queries.
  void setContact(SurfaceKind surface, double friction);
  std::uint64_t editsAnswered() const override { return editsAnswered_; }

  /// The processor, and how many threads build and edit; one answers.
  std::string machine() const override;
  double buildTime_us() const override { return sculpture_.buildTime_us(); }
  const std::vector<double>& editTimes_us() const override { return editTimes_us_; }
  std::optional<double> firstEditTime_s() const override { return firstEditTime_s_; }
  const TouchShortfalls& shortfalls() const override { return shortfalls_; }
  /// Builds it anew for each edit that moves points. Between edits.
  IndexWork indexWork() const override { return {.built = sculpture_.rebuilds()}; }
  double cell() const override { return 1.0 / static_cast<double>(sculpture_.grid().grid().inverseCell); }

 private:
  SurfaceSample surface(const DVec3& x, const DVec3& facing) const override;
  Contact contactOf(ProxyTracker& tracker, const DVec3& hip) const;
  void answer(const Pose& pose);
  Contact told();
  Contact held(const Pose& pose);
  void forget();
  void editIfYielding(const DVec3& lastHip, bool realtime);
  // On the edit's own thread: everything up to last_ is its alone until it has finished.
  void edit();
  bool editFinishedWithin(double budget_us);
  void endStroke();

  CpuTouchOptions options_;
  DVec3 origin_;
  SculptReference sculpture_;
  std::optional<BrushTool> tool_;  // of the edit that runs
  double editTime_us_ = 0;         // of the edit that ran last
  std::uint64_t editsTold_ = 0;    // states

  SurfaceOptions surface_;
  ProxyTracker tracker_;
  std::optional<ToolContacts> toolContacts_;  // of many points
  std::vector<ProxyTracker> toolTrackers_;    // one for each
  ProxyTracker secondTracker_;
  SecondContact second_;
  Contact last_;  // to the HIP itself
  Pose lastPose_;
  bool editing_ = false, inStroke_ = false, brushOn_ = true;
  std::uint64_t editsAnswered_ = 0;
  double editTime_s_ = 0;  // of the pose whose answer led to the last edit
  EditPace pace_;
  std::vector<double> editTimes_us_;
  std::optional<double> firstEditTime_s_;
  TouchShortfalls shortfalls_;
  std::exception_ptr failure_;
  EditQueue queue_;
  std::unique_ptr<BackgroundTask> edit_;  // with push; goes first
};

}  // namespace palpate
