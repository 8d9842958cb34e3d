// Interaction of the particles of a kind of matter with each other, walls and bodies: the interface of the kinds.
#pragma once

#include <memory>
#include <span>

#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

class MatterLaw {
 public:
  virtual ~MatterLaw() = default;

  /// Sets the parameters; stored state is kept.
  virtual void change(const MatterScene& scene, const MatterPlan& plan) = 0;
  /// Moves particles from the predicted positions to the final ones of the substep: settles each slot once. `sums`: one
  /// per block, zeroed, with an exchange for each body.
  virtual void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
                     WorkerTeam& team) = 0;
};

/// A new kind of matter requires a file and a line here.
std::unique_ptr<MatterLaw> waterLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> sandLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> lawOf(const MatterScene& scene, const MatterPlan& plan);

}  // namespace palpate
