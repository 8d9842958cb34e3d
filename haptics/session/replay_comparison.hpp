// A recorded session beside the same run again: where force and points are not the same.
#pragma once

#include <optional>
#include <span>

#include "engine/core/edit_batch.hpp"
#include "engine/core/units.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// One side of the comparison.
struct SessionRun {
  std::span<const LoggedTick> ticks;
  const EditBatch* edits = nullptr;
};

/// How many ticks of a recording can come out the same again, and why no more.
struct ComparableTicks {
  std::size_t count = 0;
  std::string because;  ///< empty where all of them can
};
/// Against the wall clock a run can be repeated up to the first tick that was answered late, left out, or left an edit
/// out, and not at all where points were taken in the order of their arrival (`ordered` false); any run up to the first
/// gap of its log.
ComparableTicks comparableTicks(const SessionRecord& record, double rate_Hz, bool realtime, bool ordered);

struct Differences {
  std::size_t ticks = 0;  ///< that were compared
  double largestForce_N = 0;
  std::size_t forceTicks = 0;  ///< whose forces differ by more than the tolerance
  std::size_t editTicks = 0;   ///< between which the points were edited differently
  std::size_t points = 0;      ///< that are not the same in the end; 0 where the ends were not compared
  bool ends = false;           ///< the ends were compared
  std::optional<double> first_s;

  bool any() const { return forceTicks + editTicks + points > 0; }
};

struct Tolerance {
  double value = 0;  ///< N for forces, mm for places of points; 0: the same bits
  ModelScale scale;
};

/// Compares tick by tick: the force, and what was done to the points since the tick before, in any order.
Differences compareTicks(const SessionRun& recorded, const SessionRun& again, std::size_t ticks,
                         const Tolerance& tolerance);
/// Points that are not the same. Of points that are not there nothing else is compared.
std::size_t differingPoints(std::span<const PointState> a, std::span<const PointState> b, const Tolerance& tolerance);

}  // namespace palpate
