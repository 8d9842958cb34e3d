// The particles of a simulation, in the order of their cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_model.hpp"
#include "engine/matter/neighbour_lists.hpp"
#include "shaders/shared/matter.h"

namespace palpate {

/// Exchange of matter with a body: from the matter, kg m/s and kg m^2/s.
struct Exchange {
  DVec3 impulse{0};
  DVec3 angular{0};  ///< about the centre of the body

  /// `arm`: from the centre of the body, m.
  void add(const DVec3& part, const DVec3& arm) {
    impulse += part;
    angular += glm::cross(arm, part);
  }
};

/// Sums over the particles of a block in a substep.
struct BlockSums {
  DVec3 wallImpulse{0};  ///< on the walls, kg m/s
  DVec3 momentum{0};     ///< kg m/s
  double kinetic_J = 0;
  float mostCompression = 0;     ///< 1
  std::vector<Exchange> bodies;  ///< with each body
  Exchange model;                ///< with the static model
};

/// Each array has one entry per particle, indexed by slot; those of which neighbours are read have one more, at rest
/// and nowhere, for the entries that fill up a list. All steps are gathers: a slot writes only its own entries.
class MatterParticles {
 public:
  struct Config {
    MatterBox box;
    float nearest_m = 0;  ///< minimum distance of a particle to a wall
    float reach_m = 0;    ///< reach of the neighbours' weights or contacts, without the margin of the lists
    float listed_m = 0;   ///< reach of the lists
    float mass_kg = 0;    ///< of each particle
    float step_s = 0;
    const MatterModel* model = nullptr;  ///< static model in the matter, if any
  };
  MatterParticles(const Config& config, std::vector<Vec3> places);

  std::size_t size() const { return positions_.size(); }
  const Config& config() const { return config_; }
  /// Length of the substeps from now on, s.
  void setStep(float step_s) { config_.step_s = walls_.step = step_s; }

  /// Predicts the free motion of all particles: velocities change by `change` (m/s), positions follow. Rebuilds the
  /// lists and sorts the slots if a particle has moved so far that its list may miss a neighbour. False if particles
  /// are too crowded for lists.
  bool predict(const Vec3& change, WorkerTeam& team);

  /// Velocity change of the last predict(), m/s.
  const Vec3& fall() const { return fall_; }

  /// Finishes a slot's substep: changes its velocity by `change` (m/s), which includes `byModel` of the model, and
  /// moves it accordingly, keeping it inside the walls and outside the model. Adds to `sums`.
  void settle(std::size_t slot, const Vec3& change, const Vec3& byModel, BlockSums& sums) {
    const auto settled = shared::settle<float>(walls_, Vec3(places_[slot]), Vec3(velocities_[slot]), change);
    sums.wallImpulse -= double{config_.mass_kg} * DVec3(settled.stop);
    positions_[slot] = settled.place;
    nextVelocities_[slot] = Vec4(settled.velocity, 0);
    if (config_.model != nullptr) keepOutOfModel(slot, byModel, sums);
    sumUp(slot, sums);
  }
  /// The parts of settle() for a law that settles many slots at once: where it writes a slot's position and velocity,
  /// the walls that stop it, the model that does, and its part of the sums.
  std::span<Vec3> positions() { return positions_; }
  std::span<Vec4> nextVelocities() { return nextVelocities_; }
  const shared::StoppingWalls& walls() const { return walls_; }
  void keepOutOfModel(std::size_t slot, const Vec3& byModel, BlockSums& sums);
  void sumUp(std::size_t slot, BlockSums& sums) const {
    const DVec3 velocity{Vec3(nextVelocities_[slot])};
    sums.momentum += double{config_.mass_kg} * velocity;
    sums.kinetic_J += 0.5 * double{config_.mass_kg} * glm::dot(velocity, velocity);
  }
  /// After the last settle() of a substep.
  void flip() { velocities_.swap(nextVelocities_); }

  std::span<const Vec3> positions() const { return positions_; }                     ///< m
  std::span<const Vec4> velocities() const { return {velocities_.data(), size()}; }  ///< m/s
  void setVelocity(std::size_t slot, const Vec3& velocity) { velocities_[slot] = Vec4(velocity, 0); }
  std::span<const Vec4> places() const { return {places_.data(), size()}; }  ///< predicted positions, m
  /// The same with the compression in w, which a law may compute.
  std::span<const Vec4> pressed() const { return {pressed_.data(), size()}; }
  std::span<Vec4> pressed() { return {pressed_.data(), size()}; }
  std::span<const std::uint32_t> ids() const { return ids_; }  ///< permanent
  const NeighbourLists& lists() const { return lists_; }
  bool isPeriodic() const { return grid_.cells().periodic != 0; }
  Vec3 shiftOf(Neighbour neighbour) const { return grid_.shiftOf(neighbour.image); }

 private:
  bool sortAndList(WorkerTeam& team);
  Config config_;
  shared::StoppingWalls walls_;
  Vec3 fall_{0};
  CellGrid grid_;
  NeighbourLists lists_;
  std::vector<Vec3> positions_, sortedPositions_;
  std::vector<Vec4> velocities_, nextVelocities_;
  std::vector<Vec4> places_, sortedPlaces_, pressed_;
  std::vector<Vec3> listedAt_;  // positions when the lists were built; empty: not built
  std::vector<std::uint32_t> ids_, sortedIds_;
  std::vector<float> farthest2_;  // by block: maximum squared displacement since, m^2
};

}  // namespace palpate
