// Resampling in double precision on the CPU keeps the surface whole: inserts points where an edit stretches it, merges
// them where it crowds them. Every decision depends only on the positions, normals and ids of the points within the
// neighbourhood radius (shared::neighbourhoodRadius), and not on the order in which points are examined. Unevenness of
// the loaded cloud is kept: every point knows its rest position, and only points that have moved relative to their
// neighbours are resampled.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/edit/resample_neighbours.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

/// The request of an unsettled point in one tick.
struct ResampleRequest {
  bool goes = false;        ///< the point is merged into a neighbour, or removed
  bool unsettled = false;   ///< the point must be examined again in the next tick, even if its request is carried out
  bool inserts = false;     ///< the point requests a new point
  DVec3 offset{0};          ///< of the new point
  std::uint32_t other = 0;  ///< number of the neighbour on the other side of the gap
  /// New room of the point in this stroke, if any was seen: SculptedPoints::FoundState, model units.
  std::optional<double> room;
  bool takesAfterOther = false;  ///< the other end's target is the wider one: the new point gets its parent
};

class InsertionClaims;

/// The neighbourhood of the deciding point.
struct ResampleView {
  ResampleNeighbours& neighbours;                           ///< all others within the neighbourhood radius
  double reach = std::numeric_limits<double>::infinity();   ///< maximum distance of a new point, model units
  double widest = std::numeric_limits<double>::infinity();  ///< no target spacing is wider, model units
  /// False: no new point is requested, since the stroke is over or not all neighbours could be examined.
  bool fills = true;
  bool carves = false;             ///< a ball carves: points that it has moved out of the solid are removed
  bool moved = true;               ///< a brush has moved the point since it was inserted
  DVec3 found{0}, foundNormal{0};  ///< while a ball carves: as the stroke found the point, from its current position
  double room = std::numeric_limits<double>::infinity();  ///< the same: depth of the far sheet when last seen
  const InsertionClaims* claims = nullptr;  ///< refuse a position at which a point was inserted before; null: none
  DVec3 place{0};                           ///< of the deciding point, model units
};

/// While a ball carves, points that it has moved out of the solid are removed (shared::kSkin); new points stay where
/// they were inserted, or they would be inserted again. Points nearer than kCrowded to each other rank settled before
/// unsettled, then by number. A point is removed if the lowest-ranked of those before it stays in this tick. Otherwise
/// it requests a new point in the middle of the narrowest empty gap: a gap has a neighbour on its other side within the
/// neighbourhood radius, so that borders do not grow, and its ends have moved relative to each other, so that an
/// unedited uneven cloud has no gaps. `self`: the deciding point, its offset zero.
ResampleRequest resampleRequest(const ResampleNeighbour& self, const ResampleView& view);

/// The distances to the nearest neighbour of the same sheet in every sector about a point; infinity for an empty
/// sector.
using SectorDistances = std::array<double, shared::kGapSectors>;
/// The minimum target spacing of a point with these distances (shared::kSectorSpacings), model units; 0 if all are
/// infinite.
double sectorSpacing(SectorDistances distances);

/// Resolves conflicting insertions: of the points that claim the same cell of the claims' grid the one with the
/// smallest number may insert, unless the claim of a neighbouring cell has a smaller number and is nearer than the
/// clearance. Three passes, each over all claims. A position at which the same stroke has inserted a point before is
/// refused: the point did not stay, and would be inserted and removed for ever.
class InsertionClaims {
 public:
  /// `spacing`: the maximum target spacing, model units.
  explicit InsertionClaims(double spacing);

  /// Begins a tick of this stroke: drops all claims, at the cost of those of the last tick.
  void begin(std::uint32_t stroke);
  /// Whether a point was inserted at this position in this stroke, as far as is remembered.
  bool wasGranted(const Vec3& place) const;
  /// `place`: position of the new point, relative to the cloud's origin; `number`: of the claiming point.
  void claim(const Vec3& place, std::uint32_t number);
  /// After all claims of a tick: the point with the smallest number stores its position.
  void confirm(const Vec3& place, std::uint32_t number);
  /// After all have confirmed: whether the claim holds.
  bool stands(const Vec3& place, std::uint32_t number) const;
  /// Remembers an insertion until the next one whose position has the same slot.
  void grant(const Vec3& place);

 private:
  struct Slot {
    std::uint32_t number = std::numeric_limits<std::uint32_t>::max();
    Vec3 place{0};
  };
  struct Granted {
    Vec3 place{0};
    std::uint32_t stroke = std::numeric_limits<std::uint32_t>::max();  // none
  };
  std::uint32_t slotOf(const IVec3& cell) const { return bucketOf(grid_, cell); }

  shared::HashGrid grid_;
  float clearance_;  // model units
  std::uint32_t stroke_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> claimed_;  // slots
  std::vector<Granted> granted_;
};

}  // namespace palpate
