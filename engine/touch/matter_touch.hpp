// Hands in matter that moves by itself: each holds a ball, which the matter pushes.
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
  std::size_t hands = 1;  ///< as many as the simulation has tools
  unsigned threads = 0;   ///< for pictures; 0: one per core
  bool realtime =
      false;            ///< at first (setRealtime()): on a thread of its own, and no tick waits for it past its budget
  std::string machine;  ///< that simulates
  /// Particles come and go, so that each frame says their colours.
  bool varies = false;
};

/// A simulation that is felt, and seen as a cloud: a point for each particle, in the order of their ids. In virtual
/// time it goes as far as the poses do, so that the same poses give the same bytes. Against the clock it follows them:
/// where it has no answer to a tick in time, the hand feels the last one with the stiffness of its ball's spring, and
/// ever less of it as it grows old. Once it has failed no answer is valid, until it is reset. Nothing of it can be
/// sculpted.
class MatterTouch final : public TouchBackend {
 public:
  /// The scene has a tool.
  MatterTouch(std::unique_ptr<MatterSimulation> simulation, const MatterTouchOptions& options);

  std::size_t hands() const noexcept override { return answers_.size(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void resetHand(std::size_t hand) noexcept override { ++putDown_[hand]; }
  void setRealtime(bool realtime) override;
  /// Throws Error where the simulation has failed.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;
  /// In virtual time for the thread that queries, which finds the particles as the last answer has left them.
  bool takeFrame(CloudFrame& frame) override;
  /// Of matter that somebody else simulates.
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
  mutable MatterSurface surface_;  // of the one who shows it
  MatterView view_;
  struct Still {
    std::vector<Vec3> positions, normals;
  } still_;                             // points of a model that stands in the matter, units
  std::mutex paceGuard_;                // of whether there is a thread, and of what is done in the place of one
  std::optional<MatterThread> thread_;  // against the clock; goes first
};

/// The points of a scene as it begins, mm: a cloud that is felt by MatterTouch. Those of `model`, which stands in the
/// matter where it is not null, follow those of the particles. Throws Error as planOf() does.
PointCloud cloudOf(const MatterScene& scene, const MatterModel* model, unsigned threads);

}  // namespace palpate
