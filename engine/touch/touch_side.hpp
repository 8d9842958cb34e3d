#pragma once

#include <exception>
#include <optional>
#include <vector>

#include "engine/contact/contact_step.hpp"
#include "engine/edit/edit_fetch.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/gpu/device.hpp"
#include "engine/touch/edit_pipeline.hpp"
#include "engine/touch/gpu_points.hpp"
#include "engine/touch/live_index.hpp"
#include "engine/touch/patch_bridge.hpp"
#include "engine/touch/probe_group.hpp"
#include "engine/touch/question_pipeline.hpp"
#include "engine/touch/rest_watch.hpp"
#include "engine/touch/touch_backend.hpp"
#include "engine/touch/touch_frames.hpp"
#include "engine/touch/touch_options.hpp"
#include "engine/touch/touch_statistics.hpp"

namespace palpate {

/// The touch side: owns the live cloud and its index, and answers each pose with one small command buffer recorded
/// ahead (pose, gather, surface, proxy, answer); two if the query method needs the host in between. When the answer
/// says that the surface yields, a second command buffer is submitted that edits the points and updates the index; only
/// the next tick's query waits for it. While a question exceeds its tick's budget, the CPU answers ticks from the last
/// patch of points that the GPU returned.
///
/// Submitting takes longer than answering, so endTick() can submit the next question ahead: it waits on the GPU until
/// the host has written the pose into its memory, which also keeps the GPU awake between ticks. In real time it does so
/// only while a hand moves or is near a surface, so that the GPU rests with the hand. A question that receives no pose
/// in time times out, and the next pose is submitted in the ordinary way.
///
/// While all hands rest so, only some ticks ask the GPU, which may lower its clock; the last answer stands for the
/// others.
///
/// A tool of many points is one question with a probe for each point and one for the HIP, where the brush works; one
/// dispatch answers all probes. While the answer is late, the patch answers for the points that it covers, each with a
/// proxy that continues from the GPU's; the other points keep their last tangent plane (heldContact). Further hands are
/// more probes of the same dispatch; the patch is around the first hand, and the others keep their planes.
class TouchSide final : public TouchBackend, private EditStream, private GpuPoints {
 public:
  /// `cloud` must have normals. Uploads it and builds the index. Throws OutOfGpuMemory before any upload if the cloud
  /// cannot fit.
  TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options);
  ~TouchSide() override;

  /// When the GPU is late, the last patch answers (PatchBridge) and `fresh` is false.
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  std::size_t hands() const noexcept override { return hands_.size(); }
  void endTick() noexcept override;
  std::span<const PointContact> points(std::size_t hand) const noexcept override {
    return hands_[hand].probes.points();
  }
  void resetHand(std::size_t hand) noexcept override;
  /// Also publishes the last edit to the log.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  EditStream* edits() noexcept override { return this; }
  FrameStream* frames() noexcept override { return frames_.move() ? &frames_ : nullptr; }
  GpuPoints* gpuPoints() noexcept override { return this; }
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void awaitRelease() override {
    if (edits_) edits_->awaitRelease();
  }
  void setContact(SurfaceKind surface, double friction, std::string_view method) override;
  std::vector<ProxyTracker::State> contacts() const override;
  void restoreContacts(std::span<const ProxyTracker::State> states) override;
  BridgedTicks bridged() const noexcept override { return bridged_.sum(); }
  BackendReport report() const override;
  std::vector<PassRecord> passes() const override;

  Device& device() const { return device_; }
  EditLog& editLog() { return record_.log; }
  const LiveCloud& live() const { return index_.cloud(); }
  const SpatialHash& hash() const { return index_.hash(); }
  const ContactStep& contact() const { return questions_.contact(); }
  /// Null if points are not edited.
  const EditPass* editPass() const { return edits_ ? &edits_->pass() : nullptr; }
  /// Whether questions are submitted ahead of their poses.
  bool asksAhead() const { return questions_.asksAhead(); }
  /// Whether one waits on the GPU for its pose.
  bool waitsForPose() const { return questions_.state() == QuestionState::waitingForPose; }
  /// Number of questions so far: fewer than poses while all hands rest away from all surfaces.
  std::uint32_t questions() const { return questions_.count(); }
  /// Number of questions answered that way.
  std::uint64_t answeredAhead() const { return questions_.answeredAhead(); }

 private:
  // Bridged state of a tool point: the patch's contacts since the GPU's answer.
  struct BridgedPoint {
    ProxyTracker tracker;
    bool ahead = false;  // newer than the GPU's state
  };
  // State of a probe after the GPU's last answer.
  struct ProbeState {
    ProxyTracker::State state;
    bool restored = false;  // to be passed to the GPU, which has another one
  };
  struct GpuHand {
    ProbeGroup probes;
    std::uint32_t firstProbe;
    std::vector<BridgedPoint> points;
  };
  // Record of edits, for the readers that follow them.
  struct EditRecord {
    EditLog log;
    std::optional<EditFetch> fetch;  // if edits are taken (keepEdits())
    std::uint64_t answered = 0;      // log entries published at the last answer
  };

  // The stream of its edits.
  void keep() override { record_.fetch.emplace(device_, record_.log); }
  void take(EditBatch& batch) override { record_.fetch->take(batch); }
  std::optional<EditRoom> room() const override { return EditRoom{record_.log.room(), record_.log.capacity()}; }
  EditProgress progress() const noexcept override {
    return {.states = record_.answered, .dropped = statistics_.shortfalls.droppedEdits()};
  }
  BlockedMoves blocked() const noexcept override { return edits_ ? edits_->blocked() : BlockedMoves{}; }
  void change(std::span<const PointChange> changes) override;
  bool replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) override;
  void lock(const PointLock& lock) override;
  bool offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) override {
    return edits_ && edits_->offered().give(changes, changesFollowed);
  }
  std::size_t mostOffered() const override { return edits_ ? edits_->offered().most() : 0; }
  // Its points on the GPU.
  EditLog* editLogOn(const Device& sight) override { return &sight == &device_ ? &record_.log : nullptr; }
  FramePipeline* framesOn(const Device& sight) override { return &sight == &device_ ? frames_.pipeline() : nullptr; }

  EditScope scope() const;
  EditCosts costs() const;
  BackendMemory memory() const;
  std::vector<GpuHand> makeHands() const;
  ContactOptions contactOptions() const;
  void makeBridge();
  void goOnFrom(std::span<const ProxyTracker::State> states);
  // Records all lists, for both halves of the cloud.
  void recordAll();
  // Starts what follows an answer: frames, the next patch, and the edit.
  void followAnswer();
  // Continues the source's frames between ticks.
  void bringFrame(double time_s);
  // Waits for the question in flight.
  void settle();
  bool isFiniteAt(std::span<const Pose> poses) const;
  // Asks one tick. False if the answer is late.
  bool isAnsweredWithin(std::span<const Pose> poses, double budget_us);
  // Whether the last answer also answers these poses: hands that rest away from all surfaces.
  bool mayRepeat(std::span<const Pose> poses) const;
  void submitQuestion(std::span<const Pose> poses, bool realtime);
  // Takes the answer if it arrives within the budget (0: no limit). `now_s`: time of the present pose.
  bool answerWithin(double budget_us, double now_s);
  // Takes the answer to an earlier tick's question. False while it is still in flight.
  bool lateAnswerIsIn(double now_s, double budget_us);
  void takeAnswer(double now_s);
  // All entries of the log before `head` are complete.
  void publish(std::uint32_t head);
  // Takes the answers of the probes of one hand; returns their flags (shared::kSample...).
  std::uint32_t takeAnswers(GpuHand& hand);
  // Substitutes for the answers in a tick without any.
  void bridge(std::span<const Pose> poses);
  void fail(std::span<const Pose> poses);
  // Current answer of each hand.
  std::span<const Contact> given();
  void forget(GpuHand& hand);
  void editIfYielding(bool realtime);
  // Whether the next question waits on the GPU from now on.
  bool waitsAhead();

  Device& device_;
  TouchOptions options_;
  DVec3 origin_;
  std::vector<GpuHand> hands_;
  std::vector<Contact> answers_;  // one per hand
  std::vector<ProbeState> states_;
  TouchStatistics statistics_;
  BridgedCount bridged_;
  LiveIndex index_;
  EditRecord record_;
  QuestionPipeline questions_;
  TouchFrames frames_;
  RestWatch rest_;
  std::optional<EditPipeline> edits_;  // if points are edited
  std::optional<PatchBridge> bridge_;  // for the first hand
  std::exception_ptr failure_;
};

}  // namespace palpate
