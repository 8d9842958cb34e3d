// Hands in simulated matter: each holds a ball, which the matter pushes.
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/latest_value.hpp"
#include "engine/core/semaphore.hpp"
#include "engine/matter/matter_steps.hpp"
#include "engine/matter/matter_surface.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// A simulation against the clock, on a thread of its own; no tick waits for it longer than its budget.
class MatterThread {
 public:
  /// `steps` must outlive it.
  explicit MatterThread(MatterSteps& steps);
  ~MatterThread();
  MatterThread(const MatterThread&) = delete;
  MatterThread& operator=(const MatterThread&) = delete;

  /// Returns the newest answer: the one to this question if it arrives within `budget_us` (0: no limit); nullopt before
  /// the first answer. Allocates nothing and takes no lock. For one thread.
  std::optional<MatterAnswer> ask(const MatterQuestion& question, double budget_us) noexcept;
  /// Waits for the answer to the last question, if there was one.
  void finish();

 private:
  void serve();

  MatterSteps& steps_;
  LatestValue<MatterQuestion> asked_;
  LatestValue<MatterAnswer> answered_;
  std::optional<MatterAnswer> last_;
  std::optional<double> askedAt_s_;  // of the last question
  bool spins_;                       // spins within a budget, as a sleeping thread occasionally wakes a whole tick late
  Semaphore wake_, done_;
  std::atomic<bool> stop_ = false;
  std::jthread thread_;  // destroyed first
};

/// A unit of the points of a scene is a millimetre.
inline constexpr double kMatterUnit_m = kCarriedUnit_m;

struct MatterTouchOptions {
  std::size_t hands = 1;  ///< equals the number of tools of the simulation
  unsigned threads = 0;   ///< threads for pictures; 0: one per core
  bool realtime = false;  ///< initial value of begin(): the simulation runs on a thread of its own, and no tick
                          ///< waits for it past its budget
  std::string machine;    ///< name of the machine that simulates
};

/// A simulation that is felt, and seen as a cloud: a point for each particle, in the order of their ids. In virtual
/// time it advances to the time of the poses, so that the same poses give the same bytes. Against the clock it follows
/// them: without an answer in time the hand feels the last one with the stiffness of its ball's spring, fading with the
/// answer's age. After a failure no answer is valid until a reset. It cannot be sculpted.
class MatterTouch final : public TouchBackend, private FrameStream {
 public:
  /// The scene must have a tool.
  MatterTouch(std::unique_ptr<MatterSimulation> simulation, const MatterTouchOptions& options);

  std::size_t hands() const noexcept override { return answers_.size(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void resetHand(std::size_t hand) noexcept override { ++putDown_[hand]; }
  void begin(bool realtime, std::span<const HandSpring>) override { setRealtime(realtime); }
  /// Throws Error if the simulation has failed.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  FrameStream* frames() noexcept override { return this; }
  SimulationControl* simulation() noexcept override { return &steps_; }
  void setBrush(const std::optional<BrushOptions>& brush) override;
  BackendReport report() const override {
    return {.machine = machine_, .scope = {.edits = false, .paints = false, .newPoints = 0}, .build_us = build_us_};
  }

 private:
  void setRealtime(bool realtime);
  // In virtual time only for the thread that queries; it gets the particles in the state after the last answer.
  bool take(CloudFrame& frame) override;
  std::optional<PointsTime> time() const noexcept override { return std::nullopt; }
  Contact contactOf(const MatterAnswer& answer, std::size_t hand, const Pose& pose) const noexcept;

  Vec3 up_;
  std::string machine_;
  double build_us_ = 0;
  MatterSteps steps_;
  std::vector<Contact> answers_;
  std::array<std::uint32_t, kMaxHands> putDown_{};
  mutable MatterSurface surface_;  // used by the thread that shows it
  MatterView view_;
  struct Still {
    std::vector<Vec3> positions, normals;
  } still_;                             // points of a static model in the matter, units
  std::mutex paceGuard_;                // guards thread_'s presence, and the calls that replace the thread
  std::optional<MatterThread> thread_;  // if against the clock; destroyed first
};

/// The initial points of a scene, mm: a cloud that is felt by MatterTouch. The points of `model`, a static model in the
/// matter if not null, follow those of the particles. Throws Error as planOf() does.
PointCloud cloudOf(const MatterScene& scene, const MatterModel* model, unsigned threads);
/// Appends the points of a static model, units.
void addModel(const MatterModel& model, std::vector<Vec3>& positions, std::vector<Vec3>& normals);
/// Gives a frame the colours of particles and, for its last `standing` points, of a static model.
void colorMatter(CloudFrame& frame, Matter matter, std::size_t standing);

}  // namespace palpate
