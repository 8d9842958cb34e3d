// A scene of particles that move by themselves, and what it says of itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

/// How a simulation is. Anything but running stays so until it is reset; forces are zero then, and nothing moves.
enum class MatterState {
  running,
  diverged,  ///< a velocity is no number, or matter moves faster than its sound as a whole
  crowded,   ///< more particles in one place than can be listed
};

/// All in SI units.
struct MatterObservation {
  double time_s = 0;
  std::size_t particles = 0;
  double kinetic_J = 0;
  double potential_J = 0;     ///< in gravity, from the corner at 0
  DVec3 momentum{0};          ///< kg m/s
  double maxCompression = 0;  ///< share by which the densest place exceeds the density at rest
  double front_m = 0;         ///< along x, how far matter has come: half a spacing beyond the farthest particle
};

/// What has gone between matter and all else since the beginning, kg m/s; the momentum is their sum.
struct MatterImpulses {
  DVec3 gravity{0}, onWalls{0}, onTools{0};
};

struct MatterOptions {
  unsigned threads = 0;  ///< 0: one per core; results are the same for any number
  std::size_t tools = 0;
  std::uint64_t memory_bytes = kMostMatterBytes;
};

/// For one thread at a time. The same scene and the same hands give the same bytes, for any number of threads.
class MatterWorld {
 public:
  /// Of water or sand; for soft bodies see soft_world.hpp. Throws Error as planOf() does.
  explicit MatterWorld(const MatterScene& scene, const MatterOptions& options = {});
  /// The same with particles elsewhere than at rest in the fill, m; those outside of the box stand at its walls.
  MatterWorld(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places);
  ~MatterWorld();

  const MatterPlan& plan() const { return plan_; }
  /// Puts everything back to where it began; tools are placed anew by the next step.
  void reset();
  /// kMatterStep_s further. `hands`: one for each tool, where they are at the end of the step; the first ones say where
  /// the tools begin.
  void step(std::span<const HandPose> hands = {});

  MatterState state() const { return state_; }
  double time_s() const { return static_cast<double>(steps_) * kMatterStep_s; }
  std::span<const ToolAnswer> answers() const { return answers_; }  ///< of the last step
  double portEnergy_J(std::size_t tool) const { return tools_[tool].portEnergy_J(); }
  const MatterImpulses& impulses() const { return impulses_; }
  MatterObservation observe() const;
  /// Pressure about a place, m, of what lies above where there is gravity; linear in the particles within three
  /// spacings, of which those at a wall hardly count: part of what goes through them is the wall's. 0 where no matter
  /// is. Pa.
  double pressureAt(const DVec3& place) const;

  /// In the order of the ids, m.
  std::vector<Vec3> positionsById() const;
  std::vector<Vec3> velocitiesById() const;  ///< m/s
  /// In any order; for tests that begin with a motion.
  MatterParticles& particles() { return *particles_; }

 private:
  void substep(std::span<const HandPose> from, std::span<const HandPose> to, double share);
  void judge();
  bool isAtWall(const Vec3& place) const;

  MatterScene scene_;
  MatterPlan plan_;
  std::vector<Vec3> beginning_;
  WorkerTeam team_;
  std::unique_ptr<MatterLaw> law_;
  std::unique_ptr<MatterParticles> particles_;
  std::vector<ToolBody> tools_;
  std::vector<BoundaryBody> bodies_;
  std::vector<HandPose> hands_;  // at the end of the last step; empty before the first
  std::vector<ToolAnswer> answers_;
  std::vector<BlockSums> sums_;
  BlockSums total_;
  MatterImpulses impulses_;
  MatterState state_ = MatterState::running;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate
