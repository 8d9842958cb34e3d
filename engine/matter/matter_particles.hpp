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

/// What went between matter and something else: from the matter, kg m/s and kg m^2/s.
struct Exchange {
  DVec3 impulse{0};
  DVec3 angular{0};  ///< about the middle of the body

  /// `arm`: from the middle of the body, m.
  void add(const DVec3& part, const DVec3& arm) {
    impulse += part;
    angular += glm::cross(arm, part);
  }
};

/// What the particles of a block have come to in a substep.
struct BlockSums {
  DVec3 wallImpulse{0};  ///< on the walls, kg m/s
  DVec3 momentum{0};     ///< kg m/s
  double kinetic_J = 0;
  float mostCompression = 0;     ///< 1
  std::vector<Exchange> bodies;  ///< with each body
  Exchange model;                ///< with the model that stands in the matter
};

/// Each array has one entry a particle, in slots. All steps are gathers: a slot writes its own entries.
class MatterParticles {
 public:
  struct Config {
    MatterBox box;
    float nearest_m = 0;  ///< to a wall that a particle may come
    float reach_m = 0;    ///< of the neighbours' weights or contacts, without what lists add to it
    float listed_m = 0;   ///< so far the lists reach
    float mass_kg = 0;    ///< of each
    float step_s = 0;
    const MatterModel* model = nullptr;  ///< that stands in the matter, where there is one
  };
  MatterParticles(const Config& config, std::vector<Vec3> places);

  std::size_t size() const { return positions_.size(); }
  const Config& config() const { return config_; }
  /// Length of the substeps from now on, s.
  void setStep(float step_s) { config_.step_s = step_s; }

  /// Where all of them go by themselves: velocities change by `change` (m/s), places follow. Lists are made again, and
  /// slots sorted, where one has gone so far that they may miss a neighbour. False where they are too crowded for that.
  bool predict(const Vec3& change, WorkerTeam& team);

  /// What predict() changed all velocities by, m/s.
  const Vec3& fall() const { return fall_; }

  /// Of a slot: `change` (m/s) of its velocity, of which `byModel` is the model's, and where it is then, but inside of
  /// the walls and outside of the model. Adds to `sums`. One that is held by a share gets the rest of `change`, and is
  /// free behind the substep.
  void settle(std::size_t slot, const Vec3& change, const Vec3& byModel, BlockSums& sums);
  /// Behind the last settle() of a substep.
  void flip() { velocities_.swap(nextVelocities_); }

  std::span<const Vec3> positions() const { return positions_; }  ///< m
  /// m/s. In w the share of what others do to a particle that does not move it through the next substep, from 0 to 1.
  std::span<const Vec4> velocities() const { return velocities_; }
  void setVelocity(std::size_t slot, const Vec3& velocity, float held = 0) { velocities_[slot] = Vec4(velocity, held); }
  std::span<const Vec4> places() const { return places_; }  ///< predicted, m
  /// The same with the compression in w, which a law may find.
  std::span<const Vec4> pressed() const { return pressed_; }
  std::span<Vec4> pressed() { return pressed_; }
  std::span<const std::uint32_t> ids() const { return ids_; }  ///< for life
  const NeighbourLists& lists() const { return lists_; }
  bool isPeriodic() const { return grid_.cells().periodic != 0; }
  Vec3 shiftOf(Neighbour neighbour) const { return grid_.shiftOf(neighbour.image); }

 private:
  bool sortAndList(WorkerTeam& team);
  shared::StoppingWalls walls() const;

  Config config_;
  Vec3 fall_{0};
  CellGrid grid_;
  NeighbourLists lists_;
  std::vector<Vec3> positions_, sortedPositions_;
  std::vector<Vec4> velocities_, nextVelocities_;
  std::vector<Vec4> places_, sortedPlaces_, pressed_;
  std::vector<Vec3> listedAt_;  // places when the lists were made; empty: they were not
  std::vector<std::uint32_t> ids_, sortedIds_, order_;
  std::vector<float> farthest2_;  // by block: gone since, m^2
};

}  // namespace palpate
