// Comparison of a recorded session with its replay: differences of forces and points.
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

/// The number of ticks of a recording that can be reproduced, and the reason of the limit.
struct ComparableTicks {
  std::size_t count = 0;
  std::string because;  ///< empty: all can
};
/// A run against the wall clock can be reproduced up to the first tick that was answered late, left out, or dropped an
/// edit, and not at all if points were taken in the order of their arrival (`ordered` false); any run up to the first
/// gap of its log.
ComparableTicks comparableTicks(const SessionRecord& record, double rate_Hz, bool realtime, bool ordered);

struct Differences {
  std::size_t ticks = 0;  ///< compared ones
  double largestForce_N = 0;
  std::size_t forceTicks = 0;  ///< with forces that differ by more than the tolerance
  std::size_t editTicks = 0;   ///< between which the edits differ
  std::size_t points = 0;      ///< that differ in the end; 0 if the ends were not compared
  std::size_t attributes = 0;  ///< masks and fields that differ in the end; likewise
  bool ends = false;           ///< the ends were compared
  std::optional<double> first_s;

  bool any() const { return forceTicks + editTicks + points + attributes > 0; }
};

struct Tolerance {
  double value = 0;  ///< N for forces, mm for positions of points; 0: the same bits
  ModelScale scale;
};

/// Compares tick by tick: the force, and the edits since the previous tick, in any order.
Differences compareTicks(const SessionRun& recorded, const SessionRun& again, std::size_t ticks,
                         const Tolerance& tolerance);
/// Number of points that differ. For removed points only the removal is compared.
std::size_t differingPoints(std::span<const PointState> a, std::span<const PointState> b, const Tolerance& tolerance);

}  // namespace palpate
