#pragma once

#include <exception>
#include <optional>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/cpu_edits.hpp"
#include "engine/touch/cpu_frames.hpp"
#include "engine/touch/probe_group.hpp"

namespace palpate {

struct CpuTouchOptions {
  double radius = 0;  ///< support radius, model units
  double cell = 0;    ///< edge of a grid cell, model units; 0: the support radius
  BucketKey bucketKey = BucketKey::teschner;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;  ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;       ///< of the support radius, where the surface is flat; edits are narrow
  double friction = 0;       ///< coefficient, of a proxy that slides
  /// What each hand touches with, model units; one hand with the HIP alone unless given. The first one may have a
  /// brush.
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);
  std::optional<BrushOptions> brush;  ///< edit while touching, where the HIP itself does
  unsigned threads = 0;               ///< that build the index and refit normals; 0: one per core
  CloudSource* source = nullptr;      ///< moves the points, which have no brush then; outlives what it moves
  std::optional<PointExtent>
      extent;  ///< of all points, where the cloud and the frames are a part of them: of their grid
};

/// The whole loop on the CPU, in double precision: for machines without a GPU, and the peer that GPUs are held against.
/// The surface is evaluated wherever the proxy goes, straight from the index. When the surface yields, a thread of its
/// own edits the points and builds the index anew; nobody waits for it but the next tick's query. A tool of many points
/// is felt point by point, one after another, each with a proxy of its own; and so are further hands.
class CpuTouch final : public TouchBackend, private SurfaceField {
 public:
  /// Copies what it needs of `cloud`, which must have normals, and builds the index.
  CpuTouch(const PointCloud& cloud, const CpuTouchOptions& options);

  /// While an edit outlasts the budget, the last answer is held (heldContact), and `fresh` says so. The query itself is
  /// not cut short: on an even cloud it takes some ten microseconds.
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void prepare() noexcept override;
  std::size_t hands() const noexcept override { return hands_.size(); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override {
    return hands_[hand].probes.points();
  }
  void resetHand(std::size_t hand) noexcept override;
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  bool takeFrame(CloudFrame& frame) override { return frames_ && frames_->take(frame); }
  std::optional<PointsTime> pointsTime() const noexcept override {
    return frames_ ? std::optional(frames_->frame().time()) : std::nullopt;
  }
  EditScope editScope() const override;

  bool keepsEdits() const override { return true; }
  void keepEdits() override { edits_.queue().keep(); }
  void takeEdits(EditBatch& batch) override { edits_.queue().take(batch); }
  void change(std::span<const PointChange> changes) override;
  bool offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) override {
    return edits_.offered().give(changes, changesFollowed);
  }
  std::size_t mostOffered() const override { return edits_.offered().most(); }
  /// Density is kept where the first brush kept it.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void setContact(SurfaceKind surface, double friction, std::string_view method) override;
  std::uint64_t editsAnswered() const override { return edits_.answered(); }

  /// The processor, and how many threads build and edit; one answers.
  std::string machine() const override;
  double buildTime_us() const override { return sculpture_.buildTime_us(); }
  const std::vector<double>& editTimes_us() const override { return edits_.statistics().editTimes_us; }
  std::optional<double> firstEditTime_s() const override { return edits_.statistics().firstEditTime_s; }
  const TouchShortfalls& shortfalls() const override { return edits_.statistics().shortfalls; }
  /// Builds it anew for each edit that moves points, and for each frame. Between edits.
  IndexWork indexWork() const override { return {.built = sculpture_.rebuilds() + (frames_ ? frames_->count() : 0)}; }
  EditCosts editCosts() const override { return {.states = editsAnswered()}; }
  double cell() const override { return 1.0 / static_cast<double>(sculpture_.grid().grid().inverseCell); }

 private:
  struct CpuHand {
    ProbeGroup probes;
    std::vector<ProxyTracker> trackers;  // one for each probe
  };
  SurfaceSample surface(const DVec3& x, const DVec3& facing) const override;
  DVec3 velocity(const DVec3& x, const DVec3& facing) const override;
  template <class Visit>
  void forEachNear(const DVec3& x, double radius, Visit&& visit) const;
  Contact contactOf(ProxyTracker& tracker, const DVec3& hip, double now_s);
  bool isFiniteAt(std::span<const Pose> poses) const;
  void answer(std::span<const Pose> poses, bool realtime);
  void feel(CpuHand& hand, const Pose& pose);
  // The answer to each hand, as it stands.
  std::span<const Contact> given();
  static void forget(CpuHand& hand);

  CpuTouchOptions options_;
  DVec3 origin_;
  CpuSculpture sculpture_;
  std::optional<CpuFrames> frames_;  // where a source moves the points
  bool realtime_ = false;            // of the last question
  double age_s_ = 0;                 // of the frame's points, at its time
  DVec3 ofSurface_{0};               // velocity of the surface in whose frame the question is answered
  SurfaceOptions surface_;
  std::vector<CpuHand> hands_;
  std::vector<Contact> answers_;  // one for each
  std::exception_ptr failure_;
  CpuEdits edits_;  // goes first: its thread works on the sculpture
};

}  // namespace palpate
