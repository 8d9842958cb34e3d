// A scene of matter that moves by itself, and what it says of itself: the seam between the CPU (MatterWorld) and a GPU
// (GpuMatterWorld).
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

/// How a simulation is. Anything but running stays so until it is reset; forces are zero then, and nothing moves.
enum class MatterState {
  running,
  diverged,  ///< a velocity is no number, or matter moves faster than its sound as a whole
  crowded,   ///< more particles in one place than can be listed
};

/// All particles together, after a substep.
struct MatterTotals {
  double kinetic_J = 0;
  DVec3 momentum{0};          ///< kg m/s
  double maxCompression = 0;  ///< share by which the densest place exceeds the density at rest
};

/// All in SI units.
struct MatterObservation : MatterTotals {
  double time_s = 0;
  std::size_t particles = 0;
  double potential_J = 0;  ///< in gravity, from the corner at 0
  double front_m = 0;      ///< along x, how far matter has come: half a spacing beyond the farthest particle
};

/// What has gone between matter and all else since the beginning, kg m/s; the momentum is their sum.
struct MatterImpulses {
  DVec3 gravity{0}, onWalls{0}, onModel{0};
  DVec3 onTools{0};  ///< and on hands that press on a surface
};

/// What matter does to the model that stands in it, means over a step; 0 where there is none.
struct ModelAnswer {
  DVec3 force_N{0};
  DVec3 torque_Nm{0};  ///< about the middle of its volume
};

/// What a hand is answered, means over a step. Zero where the simulation has failed.
struct ToolAnswer {
  DVec3 force_N{0};         ///< of the spring and damper on the hand, times the scene's gain
  DVec3 torque_Nm{0};       ///< of the matter on the ball about its middle, times the gain
  DVec3 reaction_N{0};      ///< of the matter on the ball: the sum of the impulses exchanged, over the step
  DVec3 byModel_N{0};       ///< on the ball, of the model that stands in the matter and stops it
  DVec3 place_m{0};         ///< of the ball at the end
  DVec3 velocity_m_s{0};    ///< of the ball at the end
  double coupling_N_m = 0;  ///< stiffness of the spring between hand and ball, times the gain
};

/// What a step has done to the ball of a tool: kg m/s, kg m^2/s.
struct ToolReport {
  DVec3 springImpulse{0};  ///< of the hand, through the spring and damper
  DVec3 impulse{0};        ///< of the matter
  DVec3 angular{0};        ///< of the matter, about its middle
  DVec3 modelImpulse{0};   ///< of the model that stands in the matter
  double portWork_J = 0;   ///< of the hand
  DVec3 place_m{0};        ///< at the end
  DVec3 velocity_m_s{0};   ///< at the end
};

struct MatterOptions {
  unsigned threads = 0;  ///< of the CPU; 0: one per core; results are the same for any number
  std::size_t tools = 0;
  std::uint64_t memory_bytes = 0;  ///< that it may take; 0: half of what the machine has on which it runs
  /// Of a scene of water or sand whose model is a file; others are made from the scene.
  std::shared_ptr<const MatterModel> model = nullptr;
  bool timesPasses = false;  ///< on a GPU, one by one, which holds it up
  /// What a soft body is at rest, where it is made already, as a scan is; null: what the scene says, which names no
  /// file.
  std::shared_ptr<const SoftModel> soft;
};

/// Memory that matter may take on a machine that has so much.
constexpr std::uint64_t matterMemory(std::uint64_t machine_bytes) {
  return machine_bytes > 0 ? machine_bytes / 2 : kAnyMemory;
}
/// The same options, on a machine that has so much memory.
MatterOptions onMachine(MatterOptions options, std::uint64_t machine_bytes);

/// For one thread at a time. The same scene and the same hands give the same bytes, on the same machine.
class MatterSimulation {
 public:
  virtual ~MatterSimulation() = default;
  MatterSimulation(const MatterSimulation&) = delete;
  MatterSimulation& operator=(const MatterSimulation&) = delete;

  const MatterScene& scene() const { return scene_; }
  const MatterPlan& plan() const { return plan_; }
  std::uint64_t memory_bytes() const { return memory_bytes_; }  ///< that it may take
  std::size_t particles() const { return beginning_.size(); }
  /// Puts everything back to where it began; tools are placed anew by the next step.
  void reset();
  /// Goes on with a scene that differs from the present one by parameters alone (matter_parameters.hpp). Throws Error
  /// as planOf() does; nothing is changed then.
  void change(const MatterScene& scene);
  /// kMatterStep_s further. `hands`: one for each tool, where they are at the end of the step; the first ones say where
  /// the tools begin.
  void step(std::span<const HandPose> hands = {});
  /// The ball of a tool stands with the next step where its hand is then, at rest, wherever it was before, and what the
  /// hand has put in counts from zero. As in the first step it grows from a point where matter is.
  void placeTool(std::size_t tool);
  /// Hands that press on the surface of a soft body through the next step, and through no other. Those of one hand
  /// stand together. Only where hasSurface() says so.
  virtual void press(std::span<const SurfacePress> presses);
  /// What came of them in that step, one for each.
  virtual std::span<const PressReport> pressed() const { return {}; }
  /// Whether it has a surface that can be pressed: soft bodies have one.
  virtual bool hasSurface() const { return false; }
  /// How far that surface within `radius_m` of a place (m) gives way along the unit vector `direction` for a force on
  /// it, m/N: what a servo loop may go on with until the next step. Changes nothing.
  virtual double localCompliance_m_N(const DVec3& /*place_m*/, double /*radius_m*/, const DVec3& /*direction*/) {
    return 0;
  }

  /// What changes the shape in which it rests, between steps; null where nothing can. Stays where it is when the
  /// scene is reset, and keeps what it has made.
  virtual SoftSculpture* sculpture() { return nullptr; }
  /// Around what looks at the sculpture's body, or changes its shape: where the body is moved elsewhere it is brought
  /// to where it now is, and what has been changed is taken from there.
  virtual void beginSculpting() {}
  virtual void endSculpting() {}

  MatterState state() const { return state_; }
  double time_s() const { return static_cast<double>(steps_) * kMatterStep_s; }
  std::span<const ToolAnswer> answers() const { return answers_; }  ///< of the last step
  /// Energy that the hand of a tool has put in against the force that it got, with the gain of each step and as far as
  /// limits let it out (HandPose::felt), J. Passive where it is never below 0. Who raises the gain while a spring is
  /// stretched makes energy, which is counted like any other.
  double portEnergy_J(std::size_t tool) const { return portEnergies_J_[tool]; }
  const MatterImpulses& impulses() const { return impulses_; }
  /// That stands in the matter; nothing where there is none.
  const MatterModel* model() const { return model_.get(); }
  const ModelAnswer& onModel() const { return onModel_; }  ///< in the last step
  /// Particles that began within the ball of a tool: it grows from a point there and pushes them out, within about a
  /// fifth of a second for a ball of three spacings. 0: the ball is there at once.
  std::size_t pushedOut(std::size_t tool) const { return balls_[tool].pushedOut; }
  /// Particles that would have begun within the model, and are left out.
  std::size_t leftOut() const { return leftOut_; }
  /// Particles that are within the model now. Looks at all of them.
  std::size_t insideModel() const;
  const MatterTotals& totals() const { return totals_; }  ///< after the last substep
  /// Time of the last step on a GPU's own clock; nothing where none ran it, or it keeps none.
  virtual std::optional<double> gpuTime_us() const = 0;
  /// What the last step ran on a GPU, with times where the options ask for them.
  virtual std::vector<PassRecord> passes() const { return {}; }

  /// Of matter that somebody else simulates: for when it is known; nothing before it is, or where it is simulated here.
  virtual std::optional<double> knownAt_s() const { return std::nullopt; }
  /// Looks at all particles.
  virtual MatterObservation observe() const;
  /// Pressure of water about a place, m, of what lies above where there is gravity; linear in the particles within
  /// three spacings, of which those at a wall hardly count: part of what goes through them is the wall's. 0 where no
  /// matter is, or none that has one. Pa. Looks at all particles.
  double pressureAt(const DVec3& place) const;

  /// What is seen of it now: positions in m and velocities in m/s, of the particles or of the points that they carry,
  /// and unit normals where these have some.
  virtual void makeFrame(CloudFrame& frame);
  /// Does the same but for the way to the host. False where there is no such way, and nothing was done.
  virtual bool makeFrameThere() { return false; }
  /// Who brings what is seen to where a GPU reads it; null where it is moved on the host.
  virtual FrameCarrier* carrier() { return nullptr; }
  /// Whether what is brought there has its velocities; or else they are 0. Not while that is under way.
  virtual void carryVelocities(bool /*carries*/) {}
  /// Time of the last frame on a GPU's own clock, without the way to the host; nothing where none made one.
  virtual std::optional<double> frameTime_us() const { return std::nullopt; }
  /// In the order of the ids, m.
  virtual std::vector<Vec3> positionsById() const = 0;
  virtual std::vector<Vec3> velocitiesById() const = 0;  ///< m/s
  /// For beginnings with a motion: one for each id, m/s.
  virtual void setVelocities(std::span<const Vec3> byId) = 0;

 protected:
  /// Throws Error as planOf() does. `options`: with the memory of the machine (onMachine()). `places`: where particles
  /// begin, m; those outside of the box stand at its walls. Who derives calls reset() when it is made.
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
  /// So far from its middle the ball of a tool is there, m.
  double grown_m(std::size_t tool) const { return balls_[tool].grown_m; }
  bool growsBall(std::size_t tool) const { return grown_m(tool) < wholeBall_m(); }
  /// What gravity gives to all particles in so many substeps, kg m/s.
  DVec3 gravityOf(std::uint32_t substeps) const;

 private:
  /// Everything stands where it begins.
  virtual void begin() = 0;
  /// The scene and the plan have other parameters than before.
  virtual void takeParameters() = 0;
  /// Whether what is within a ball as it is placed is taken out of its way, so that it has not to grow there.
  virtual bool makesRoom() const { return false; }
  /// The ball of a tool stands where the hand is.
  virtual void placeToolAt(std::size_t tool, const HandPose& hand) = 0;
  /// All substeps of a step, or as many as the state lets it, while hands go from one place to another.
  virtual StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) = 0;
  /// Where particles were predicted in the last substep, m, in any order; the compression in w.
  virtual std::vector<Vec4> pressedPlaces() const = 0;

  void take(const StepReport& report, std::span<const HandPose> hands);
  void place(std::size_t tool, const HandPose& hand, std::span<const Vec3> places);
  void placeWaiting(std::span<const HandPose> hands);
  void growBalls();
  double wholeBall_m() const;  // grown so far, all of it counts in full

  // Of a tool.
  struct Ball {
    double grown_m = 0;
    std::size_t pushedOut = 0;
    bool waits = true;  // to be placed with the next step
  };

  MatterScene scene_;
  MatterPlan plan_;
  std::uint64_t memory_bytes_;
  std::shared_ptr<const MatterModel> model_;
  std::size_t leftOut_ = 0;
  std::vector<Vec3> beginning_;
  std::vector<HandPose> hands_;  // at the end of the last step
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
