// Which way the surface of matter looks at each of its particles, for pictures of it.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/cell_grid.hpp"

namespace palpate {

/// From where more matter is to where less is, about each particle (the gradient of a colour field; Mueller, Charypar,
/// Gross 2003). Keeps its memory.
class MatterSurface {
 public:
  /// `spacing_m`: of the particles at rest. `threads`: 0: one per core.
  MatterSurface(const MatterBox& box, double spacing_m, unsigned threads);

  /// Unit normals of all `places`, m, in the same order; `up` where there is as much on all sides, and 0 where a
  /// particle is by itself, and thus round. The same bytes for any number of threads.
  void normalsOf(std::span<const Vec3> places, const Vec3& up, std::vector<Vec3>& normals);

 private:
  Vec3 normalAt(std::size_t slot, const Vec3& up) const;

  float reach_;
  CellGrid grid_;
  WorkerTeam team_;
  std::vector<Vec4> places_, sorted_;
  std::vector<std::uint32_t> order_;
};

}  // namespace palpate
