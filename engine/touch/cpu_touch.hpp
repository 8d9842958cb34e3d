#pragma once

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/touch/cpu_bridge.hpp"
#include "engine/touch/cpu_edits.hpp"
#include "engine/touch/cpu_frames.hpp"
#include "engine/touch/probe_group.hpp"
#include "engine/touch/tick_limit.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

struct CpuTouchOptions {
  double radius = 0;  ///< support radius, model units
  double cell = 0;    ///< edge of a grid cell, model units; 0: the support radius
  BucketKey bucketKey = BucketKey::teschner;
  IndexFollow index = IndexFollow::incremental;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;  ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;       ///< factor on the support radius for flat surfaces; edits use the unwidened radius
  double friction = 0;       ///< friction coefficient of the proxy
  /// Tool of each hand, model units; default: one hand, HIP only. Only the first hand may have a brush.
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);
  std::optional<BrushOptions> brush;  ///< edit while touching, at the HIP
  std::optional<EditSize> editSize;   ///< default: whole in virtual time, a tick's in real time
  std::uint64_t editRoom = 0;         ///< CpuEdits::Setting::room
  unsigned threads = 0;               ///< threads that build the index and refit normals; 0: one per core
  CloudSource* source = nullptr;      ///< moves the points and excludes a brush; must outlive the touch side
  std::optional<PointExtent>
      extent;  ///< extent of all points for the grid, if the cloud and the frames hold only part of them
};

/// The whole loop on the CPU, in double precision: for machines without a GPU, and as the reference for GPUs. The
/// surface is evaluated wherever the proxy moves, directly from the index. When the surface yields, a separate thread
/// edits the points and updates the index; only the next tick's query waits for it. The points of a tool are evaluated
/// one after another, each with its own proxy; so are further hands.
class CpuTouch final : public TouchBackend, private EditStream, private SurfaceField {
 public:
  /// Copies the needed data of `cloud`, which must have normals, and builds the index.
  CpuTouch(const PointCloud& cloud, const CpuTouchOptions& options);

  /// While an edit or the query itself exceeds the budget, the last patch answers (CpuBridge) and `fresh` is false. A
  /// query that was too long is tried again after a rest (EditPace).
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void endTick() noexcept override;
  std::size_t hands() const noexcept override { return hands_.size(); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override {
    return hands_[hand].probes.points();
  }
  void resetHand(std::size_t hand) noexcept override;
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  EditStream* edits() noexcept override { return this; }
  FrameStream* frames() noexcept override { return frames_ ? &*frames_ : nullptr; }
  /// Density is kept if the first brush kept it.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void awaitRelease() override { edits_.awaitRelease(); }
  void setContact(SurfaceKind surface, double friction, std::string_view method) override;
  std::vector<ProxyTracker::State> contacts() const override;
  void restoreContacts(std::span<const ProxyTracker::State> states) override;
  /// Its machine: the processor, and the number of threads that build and edit; one thread answers. The index follows
  /// the edits, and is rebuilt for each frame.
  BridgedTicks bridged() const noexcept override { return bridged_.sum(); }
  BackendReport report() const override;

 private:
  struct CpuHand {
    ProbeGroup probes;
    std::vector<ProxyTracker> trackers;  // one per probe
    CpuBridge bridge;
    std::vector<ProxyTracker> before;  // before an answer that may be late
  };
  // The stream of its edits.
  void keep() override { edits_.queue().keep(); }
  void take(EditBatch& batch) override { edits_.queue().take(batch); }
  std::optional<EditRoom> room() const override { return edits_.queue().room(); }
  EditProgress progress() const noexcept override {
    return {.states = edits_.answered(), .dropped = edits_.statistics().shortfalls.droppedEdits()};
  }
  BlockedMoves blocked() const noexcept override { return edits_.blocked(); }
  void change(std::span<const PointChange> changes) override;
  bool replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) override;
  void lock(const PointLock& lock) override;
  bool offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) override {
    return edits_.offered().give(changes, changesFollowed);
  }
  std::size_t mostOffered() const override { return edits_.offered().most(); }

  EditScope scope() const;
  SurfaceSample surface(const DVec3& x, const DVec3& facing) const override;
  DVec3 velocity(const DVec3& x, const DVec3& facing) const override;
  template <class Visit>
  void forEachNear(const DVec3& x, double radius, Visit&& visit) const;
  Contact contactOf(ProxyTracker& tracker, const DVec3& hip, double now_s);
  bool isFiniteAt(std::span<const Pose> poses) const;
  CpuBridge makeBridge() const;
  CpuBridge::Points pointsNow() const;
  // False: a hand was bridged.
  bool answer(std::span<const Pose> poses);
  // Answers a hand from all points; false, and nothing has changed, if that would be late.
  bool feel(CpuHand& hand, const Pose& pose);
  // Answers it from its patch.
  void bridge(CpuHand& hand, const Pose& pose);
  void sculpt(const Pose& pose);
  void goOnFrom(std::span<const ProxyTracker::State> states);
  // Current answer of each hand.
  std::span<const Contact> given();
  static void forget(CpuHand& hand);

  CpuTouchOptions options_;
  std::string machine_;
  DVec3 origin_;
  CpuSculpture sculpture_;
  std::optional<CpuFrames> frames_;  // if a source moves the points
  bool realtime_ = false;            // of the last question
  double age_s_ = 0;                 // age of the frame's points at the time of the question
  DVec3 ofSurface_{0};               // velocity of the surface in whose frame of reference the question is answered
  SurfaceOptions surface_;
  std::vector<CpuHand> hands_;
  std::vector<Contact> answers_;  // one per hand
  std::exception_ptr failure_;
  mutable TickLimit limit_;             // of the tick
  EditPace attempts_{0};                // to answer from all points
  std::vector<double> bridgeTimes_us_;  // a bounded number is kept
  BridgedCount bridged_;
  CpuEdits edits_;  // destroyed first: its thread works on the sculpture
};

}  // namespace palpate
