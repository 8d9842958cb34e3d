// A simulated scene of matter and its results: the interface of the CPU (MatterWorld) and a GPU (GpuMatterWorld).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/pass_record.hpp"
#include "engine/matter/hand_pose.hpp"
#include "engine/matter/matter_model.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/surface_press.hpp"

namespace palpate {

class FrameCarrier;
class SoftSculpture;
struct SoftModel;

/// State of a simulation. Any state but running persists until a reset; forces are zero then, and nothing moves.
enum class MatterState {
  running,
  diverged,  ///< a velocity is NaN, or the kinetic energy exceeds that at the speed of sound
  crowded,   ///< more neighbours around a particle than a list can hold
};

/// Totals over all particles, after a substep.
struct MatterTotals {
  double kinetic_J = 0;
  DVec3 momentum{0};          ///< kg m/s
  double maxCompression = 0;  ///< maximum relative excess of the density over that at rest
};

/// All in SI units.
struct MatterObservation : MatterTotals {
  double time_s = 0;
  std::size_t particles = 0;
  double potential_J = 0;  ///< potential energy of gravity, relative to the corner at 0
  double front_m = 0;      ///< maximum x of the matter: half a spacing beyond the farthest particle
};

/// Impulses between matter and everything else since the start, kg m/s; the momentum is their sum.
struct MatterImpulses {
  DVec3 gravity{0}, onWalls{0}, onModel{0};
  DVec3 onTools{0};  ///< also on hands that press on a surface
};

/// Action of the matter on the static model, means over a step; 0 without a model.
struct ModelAnswer {
  DVec3 force_N{0};
  DVec3 torque_Nm{0};  ///< about the centroid of its volume
};

/// The answer to a hand, means over a step. Zero if the simulation has failed.
struct ToolAnswer {
  DVec3 force_N{0};         ///< force of the spring and damper on the hand, times the scene's gain
  DVec3 torque_Nm{0};       ///< torque of the matter on the ball about its centre, times the gain
  DVec3 reaction_N{0};      ///< force of the matter on the ball: the sum of the impulses exchanged in the step
  DVec3 byModel_N{0};       ///< force of the static model that stops the ball
  DVec3 place_m{0};         ///< of the ball at the end
  DVec3 velocity_m_s{0};    ///< of the ball at the end
  double coupling_N_m = 0;  ///< stiffness of the spring between hand and ball, times the gain
};

/// Results of a step for the ball of a tool: kg m/s, kg m^2/s.
struct ToolReport {
  DVec3 springImpulse{0};  ///< impulse of the hand, through the spring and damper
  DVec3 impulse{0};        ///< of the matter
  DVec3 angular{0};        ///< angular impulse of the matter about the ball's centre
  DVec3 modelImpulse{0};   ///< impulse of the static model
  double portWork_J = 0;   ///< work of the hand
  DVec3 place_m{0};        ///< at the end
  DVec3 velocity_m_s{0};   ///< at the end
};

struct MatterOptions {
  unsigned threads = 0;  ///< CPU threads; 0: one per core; results are the same for any number
  std::size_t tools = 0;
  std::uint64_t memory_bytes = 0;  ///< memory limit; 0: half of the memory of the machine that runs it
  /// Model of a scene of water or sand that names a file; other models are made from the scene.
  std::shared_ptr<const MatterModel> model = nullptr;
  bool timesPasses = false;  ///< times each pass on a GPU, which slows it down
  /// The soft body at rest, if already made, as from a scan; null: made from the scene, which names no file.
  std::shared_ptr<const SoftModel> soft;
};

/// Memory limit for matter on a machine with `machine_bytes` of memory.
constexpr std::uint64_t matterMemory(std::uint64_t machine_bytes) {
  return machine_bytes > 0 ? machine_bytes / 2 : kAnyMemory;
}
/// The same options with the memory limit of a machine with `machine_bytes`.
MatterOptions onMachine(MatterOptions options, std::uint64_t machine_bytes);

/// For one thread at a time. On the same machine the same scene and the same hands give the same bytes.
class MatterSimulation {
 public:
  virtual ~MatterSimulation() = default;
  MatterSimulation(const MatterSimulation&) = delete;
  MatterSimulation& operator=(const MatterSimulation&) = delete;

  const MatterScene& scene() const { return scene_; }
  const MatterPlan& plan() const { return plan_; }
  std::uint64_t memory_bytes() const { return memory_bytes_; }  ///< memory limit
  std::size_t particles() const { return beginning_.size(); }
  /// Restarts from the initial state; the next step places the tools.
  void reset();
  /// Continues with a scene that differs from the present one only in parameters (matter_parameters.hpp). Throws Error
  /// as planOf() does, without any change.
  void change(const MatterScene& scene);
  /// Advances by kMatterStep_s. `hands`: pose of each tool's hand at the end of the step; the first poses place the
  /// tools.
  void step(std::span<const HandPose> hands = {});
  /// The next step places the ball of a tool at its hand, at rest, wherever it was, and resets the hand's energy. As in
  /// the first step the ball grows from a point if matter is there.
  void placeTool(std::size_t tool);
  /// Hands that press on the surface of a soft body during the next step only. Presses of one hand are contiguous.
  /// Requires hasSurface().
  virtual void press(std::span<const SurfacePress> presses);
  /// Results of that step, one per press.
  virtual std::span<const PressReport> pressed() const { return {}; }
  /// Whether it has a surface that can be pressed, as soft bodies have.
  virtual bool hasSurface() const { return false; }
  /// Compliance of that surface within `radius_m` of a position (m) along the unit vector `direction`, m/N; a servo
  /// loop may extrapolate with it until the next step. Changes nothing.
  virtual double localCompliance_m_N(const DVec3& /*place_m*/, double /*radius_m*/, const DVec3& /*direction*/) {
    return 0;
  }

  /// Changes the rest shape, between steps; null if not supported. The object and its changes persist when the scene is
  /// reset.
  virtual SoftSculpture* sculpture() { return nullptr; }
  /// Must enclose each access to the sculpture's body or shape: if the body is simulated on a GPU, the first call
  /// downloads its state, and the second uploads the changes.
  virtual void beginSculpting() {}
  virtual void endSculpting() {}

  MatterState state() const { return state_; }
  double time_s() const { return static_cast<double>(steps_) * kMatterStep_s; }
  std::span<const ToolAnswer> answers() const { return answers_; }  ///< answers of the last step
  /// Energy that the hand of a tool has put in against its force, with the gain of each step and the share that limits
  /// let through (HandPose::felt), J. Passive if never below 0. Raising the gain while a spring is stretched creates
  /// energy, which is counted like any other.
  double portEnergy_J(std::size_t tool) const { return portEnergies_J_[tool]; }
  const MatterImpulses& impulses() const { return impulses_; }
  /// Static model in the matter; null without one.
  const MatterModel* model() const { return model_.get(); }
  const ModelAnswer& onModel() const { return onModel_; }  ///< answer of the last step
  /// Number of particles that were inside the ball of a tool when it was placed: the ball grows from a point and pushes
  /// them out, within about a fifth of a second for a radius of three spacings. 0: the ball has its full size at once.
  std::size_t pushedOut(std::size_t tool) const { return balls_[tool].pushedOut; }
  /// Number of initial particles omitted because they were inside the model.
  std::size_t leftOut() const { return leftOut_; }
  /// Number of particles inside the model now. Iterates over all particles.
  std::size_t insideModel() const;
  const MatterTotals& totals() const { return totals_; }  ///< after the last substep
  /// GPU time of the last step; nullopt if no GPU ran it, or the GPU has no timestamps.
  virtual std::optional<double> gpuTime_us() const = 0;
  /// Passes of the last step on a GPU, with times if the options request them.
  virtual std::vector<PassRecord> passes() const { return {}; }

  /// Iterates over all particles.
  virtual MatterObservation observe() const;
  /// Pressure of water at a position (m), from the matter above it if there is gravity; a linear fit over the particles
  /// within three spacings, where particles at a wall hardly count, as the wall carries part of their load. 0 without
  /// matter, or for matter without pressure. Pa. Iterates over all particles.
  double pressureAt(const DVec3& place) const;

  /// Makes the frame to draw: positions in m and velocities in m/s, of the particles or of the points that they carry,
  /// and unit normals if these have some.
  virtual void makeFrame(CloudFrame& frame);
  /// The same without the transfer to the host. False, with nothing done, if not supported.
  virtual bool makeFrameThere() { return false; }
  /// Writes the frame where a GPU reads it; null if matter is moved on the host.
  virtual FrameCarrier* carrier() { return nullptr; }
  /// Whether frames written there contain velocities; otherwise they are 0. Not while such a write is in progress.
  virtual void carryVelocities(bool /*carries*/) {}
  /// GPU time of the last frame, without the transfer to the host; nullopt if no GPU made one.
  virtual std::optional<double> frameTime_us() const { return std::nullopt; }
  /// Ordered by id, m.
  virtual std::vector<Vec3> positionsById() const = 0;
  virtual std::vector<Vec3> velocitiesById() const = 0;  ///< m/s
  /// Sets initial velocities: one per id, m/s.
  virtual void setVelocities(std::span<const Vec3> byId) = 0;

 protected:
  /// Throws Error as planOf() does. `options`: after onMachine(). `places`: initial positions of the particles, m;
  /// those outside the box are clamped to its walls. Constructors of derived classes must call reset().
  MatterSimulation(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places);

  struct StepReport {
    MatterState state = MatterState::running;
    DVec3 gravity{0}, onWalls{0};      ///< kg m/s
    DVec3 onModel{0}, turnOfModel{0};  ///< kg m/s, kg m^2/s about its middle
    DVec3 onPresses{0};                ///< kg m/s
    MatterTotals totals;
    std::vector<ToolReport> tools;
  };
  std::size_t tools() const { return answers_.size(); }
  const std::vector<Vec3>& beginning() const { return beginning_; }
  /// Distance from its centre up to which the growing ball of a tool is present, m.
  double grown_m(std::size_t tool) const { return balls_[tool].grown_m; }
  bool growsBall(std::size_t tool) const { return grown_m(tool) < wholeBall_m(); }
  /// Impulse of gravity on all particles in `substeps` substeps, kg m/s.
  DVec3 gravityOf(std::uint32_t substeps) const;

 private:
  /// Restores the initial state.
  virtual void begin() = 0;
  /// Applies the changed parameters of the scene and the plan.
  virtual void takeParameters() = 0;
  /// Places the ball of a tool at the hand.
  virtual void placeToolAt(std::size_t tool, const HandPose& hand) = 0;
  /// Runs all substeps of a step, or fewer if the state changes, while the hands move from `from` to `to`.
  virtual StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) = 0;
  /// Predicted positions in the last substep, m, in any order; w: the compression.
  virtual std::vector<Vec4> pressedPlaces() const = 0;

  void take(const StepReport& report, std::span<const HandPose> hands);
  void place(std::size_t tool, const HandPose& hand, std::span<const Vec3> places);
  void placeWaiting(std::span<const HandPose> hands);
  void growBalls();
  double wholeBall_m() const;  // grown_m at which a ball has its full effect

  // Ball of a tool.
  struct Ball {
    double grown_m = 0;
    std::size_t pushedOut = 0;
    bool waits = true;  // the next step places it
  };

  MatterScene scene_;
  MatterPlan plan_;
  std::uint64_t memory_bytes_;
  std::shared_ptr<const MatterModel> model_;
  std::size_t leftOut_ = 0;
  std::vector<Vec3> beginning_;
  std::vector<HandPose> hands_;  // poses at the end of the last step
  std::vector<Ball> balls_;
  std::vector<ToolAnswer> answers_;
  std::vector<double> portEnergies_J_;
  ModelAnswer onModel_;
  MatterTotals totals_;
  MatterImpulses impulses_;
  MatterState state_ = MatterState::running;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate
