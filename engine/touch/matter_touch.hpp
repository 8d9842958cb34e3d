// Hands in simulated matter: each holds a ball, which the matter pushes.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "engine/core/touch_backend.hpp"
#include "engine/matter/matter_surface.hpp"
#include "engine/touch/matter_steps.hpp"
#include "engine/touch/matter_thread.hpp"

namespace palpate {

/// A unit of the points of a scene is a millimetre.
inline constexpr double kMatterUnit_m = 1e-3;

struct MatterTouchOptions {
  std::size_t hands = 1;  ///< equals the number of tools of the simulation
  unsigned threads = 0;   ///< threads for pictures; 0: one per core
  bool realtime = false;  ///< initial value of setRealtime(): the simulation runs on a thread of its own, and no tick
                          ///< waits for it past its budget
  std::string machine;    ///< name of the machine that simulates
  /// The set of particles varies, so each frame includes their colours.
  bool varies = false;
};

/// A simulation that is felt, and seen as a cloud: a point for each particle, in the order of their ids. In virtual
/// time it advances to the time of the poses, so that the same poses give the same bytes. Against the clock it follows
/// them: without an answer in time the hand feels the last one with the stiffness of its ball's spring, fading with the
/// answer's age. After a failure no answer is valid until a reset. It cannot be sculpted.
class MatterTouch final : public TouchBackend {
 public:
  /// The scene must have a tool.
  MatterTouch(std::unique_ptr<MatterSimulation> simulation, const MatterTouchOptions& options);

  std::size_t hands() const noexcept override { return answers_.size(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void resetHand(std::size_t hand) noexcept override { ++putDown_[hand]; }
  void setRealtime(bool realtime) override;
  /// Throws Error if the simulation has failed.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  /// In virtual time only for the thread that queries; it gets the particles in the state after the last answer.
  bool takeFrame(CloudFrame& frame) override;
  /// Only for matter simulated on another machine.
  std::optional<PointsTime> pointsTime() const noexcept override;
  SimulationControl* simulation() override { return &steps_; }

  bool keepsEdits() const override { return true; }
  void keepEdits() override {}
  void takeEdits(EditBatch&) override {}
  EditScope editScope() const override {
    return {.edits = false, .paints = false, .newPoints = varies_ ? kMaxVarying : 0};
  }
  void setBrush(const std::optional<BrushOptions>& brush) override;

  std::string machine() const override { return machine_; }
  double buildTime_us() const override { return buildTime_us_; }
  const std::vector<double>& editTimes_us() const override { return noTimes_; }
  std::optional<double> firstEditTime_s() const override { return std::nullopt; }
  const TouchShortfalls& shortfalls() const override { return shortfalls_; }
  IndexWork indexWork() const override { return {}; }
  double cell() const override { return 0; }

 private:
  static constexpr std::uint32_t kMaxVarying = 1 << 18;
  void color(CloudFrame& frame) const;
  std::size_t bring(std::span<const Vec3> places, PointCloud& cloud) const;
  Contact contactOf(const MatterAnswer& answer, std::size_t hand, const Pose& pose) const noexcept;

  Vec3 up_;
  bool varies_;
  std::optional<double> known_s_;
  std::string machine_;
  double buildTime_us_ = 0;
  MatterSteps steps_;
  std::vector<Contact> answers_;
  std::array<std::uint32_t, kMaxHands> putDown_{};
  std::vector<double> noTimes_;
  TouchShortfalls shortfalls_;
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

}  // namespace palpate
