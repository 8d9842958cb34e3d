// The surface stays a surface, in double precision on the CPU: where an edit stretches it, points are inserted, where
// it crowds them, they are merged. Every decision depends on the places, normals and ids of the points within the look
// radius alone (shared::neighbourhoodRadius), and not on the order in which points are examined. What is uneven as it
// was loaded stays so: every point knows where it rested, and only what has moved against its neighbours is mended.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

/// A neighbour of the point that decides.
struct ResampleNeighbour {
  DVec3 offset{0};           ///< from the point that decides, model units
  DVec3 normal{0};           ///< unit
  DVec3 rest{0};             ///< where it stood in the cloud as loaded; a new one where its ends did; model units
  double spacing = 0;        ///< target, model units
  bool isNew = false;        ///< it was not in the cloud as loaded
  bool atRest = false;       ///< it stands as it was loaded
  std::uint32_t number = 0;  ///< of the point; in the order of ids
  bool unsettled = false;    ///< has moved, or is new, or has not yet got what it requested
};

/// What an unsettled point requests in one tick.
struct ResampleRequest {
  bool goes = false;             ///< it is merged into a neighbour
  bool stops = false;            ///< it has been pushed as far as the far sheet of a plate
  bool unsettled = false;        ///< it must be examined again in the next tick, whatever becomes of its request
  bool inserts = false;          ///< it requests a new point
  DVec3 offset{0};               ///< of the new point
  std::uint32_t other = 0;       ///< number of the neighbour on the other side of the gap
  std::optional<double> thick;   ///< how far under the point as found the far sheet is, where that is seen; model units
  bool takesAfterOther = false;  ///< the other end's target is the wider one: the new point gets its parent
};

/// The neighbourhood of the point that decides.
struct ResampleView {
  std::span<const ResampleNeighbour> neighbours;           ///< all others within the neighbourhood radius
  double reach = std::numeric_limits<double>::infinity();  ///< it may have a new point no further away, model units
  bool complete = true;             ///< false: there are more than could be examined, and so no new point is asked for
  bool carves = false;              ///< a ball cuts a solid: what it has moved outside of that goes
  bool moved = true;                ///< a brush has moved the point since it came
  std::optional<DVec3> pushedFrom;  ///< unit, the axis of a tool that pushes the point in this stroke
  DVec3 found{0}, foundNormal{0};   ///< while a ball carves: where and how the stroke found it, from where it is now
  double thick = std::numeric_limits<double>::infinity();  ///< how far under it the far sheet was seen last
};

/// A point that a tool pushes stops where it comes to a sheet that is turned away from the tool: the far side of a
/// plate stays as it is. While a ball carves, a point goes that it has moved outside the solid (shared::kSkin); a new
/// one stays where it came, or it would come again. Points nearer than kCrowded to one another rank settled before
/// unsettled, then by number. A point goes where the first of those before it stays itself in this tick. Otherwise it
/// requests a new point in the middle of the narrowest gap where none stands: a gap has a neighbour on its other side,
/// within the look radius, so that borders do not grow, and its ends have moved against one another, so that an uneven
/// cloud that nobody has edited has none. `self`: the point that decides, its offset zero.
ResampleRequest resampleRequest(const ResampleNeighbour& self, const ResampleView& view);

/// The distances to the nearest neighbour of the same sheet in every sector about a point; infinity where there is
/// none.
using SectorDistances = std::array<double, shared::kGapSectors>;
/// The least target of a point that has these (shared::kSectorSpacings), model units; 0 where all are infinite.
double sectorSpacing(SectorDistances distances);

/// Who may insert where: of those that want the same cell of the claims' grid the point with the smallest number,
/// unless the one of a neighbouring cell has a smaller one and wants a place nearer than the clearance. Three passes,
/// each over all that request a place.
class InsertionClaims {
 public:
  /// `spacing`: the widest target spacing, model units.
  explicit InsertionClaims(double spacing);

  void clear();
  /// `place`: of the new point, relative to the cloud's origin; `number`: of the point that wants it.
  void claim(const Vec3& place, std::uint32_t number);
  /// After all claims of a tick: whoever has the smallest number says where it wants its point.
  void confirm(const Vec3& place, std::uint32_t number);
  /// After all have confirmed.
  bool stands(const Vec3& place, std::uint32_t number) const;

 private:
  struct Slot {
    std::uint32_t number = std::numeric_limits<std::uint32_t>::max();
    Vec3 place{0};
  };
  std::uint32_t slotOf(const IVec3& cell) const { return bucketOf(grid_, cell); }

  shared::HashGrid grid_;
  float clearance_;  // model units
  std::vector<Slot> slots_;
};

}  // namespace palpate
