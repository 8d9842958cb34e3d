// What the particles of a kind of matter do to each other, to walls and to bodies: the seam between kinds.
#pragma once

#include <memory>
#include <span>

#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

inline constexpr std::uint32_t kNoParticle = ~std::uint32_t{0};

class MatterLaw {
 public:
  virtual ~MatterLaw() = default;

  /// With other parameters from now on; whatever it remembers stays.
  virtual void change(const MatterScene& scene, const MatterPlan& plan) = 0;
  /// Particles have other ids from now on: `was` says for each which one it had, or kNoParticle where it is new.
  virtual void renumber(std::span<const std::uint32_t> was) = 0;
  /// From places that were predicted to those that the substep ends with: settles each slot once. `sums`: one for each
  /// block, empty, with an exchange for each body.
  virtual void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
                     WorkerTeam& team) = 0;
};

/// A new kind of matter is a file and a line here.
std::unique_ptr<MatterLaw> waterLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> sandLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> lawOf(const MatterScene& scene, const MatterPlan& plan);

}  // namespace palpate
