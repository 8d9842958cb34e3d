// Surface normals of matter at each of its particles, for pictures.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/cell_grid.hpp"

namespace palpate {

/// Directions from more to less matter around each particle (gradient of a colour field; Mueller, Charypar, Gross
/// 2003). Keeps its memory between calls.
class MatterSurface {
 public:
  /// `spacing_m`: spacing of the particles at rest. `threads`: 0: one per core.
  MatterSurface(const MatterBox& box, double spacing_m, unsigned threads);

  /// Unit normals of all `places`, m, in the same order; `up` if there is equally much matter on all sides, and 0 for
  /// an isolated particle, which is drawn round. Bitwise identical for any number of threads.
  void normalsOf(std::span<const Vec3> places, const Vec3& up, std::vector<Vec3>& normals);

 private:
  Vec3 normalAt(std::size_t slot, const Vec3& up) const;

  float reach_;
  CellGrid grid_;
  WorkerTeam team_;
  std::vector<Vec4> places_, sorted_;
};

}  // namespace palpate
