#pragma once

#include "apps/model.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// What a touch session came to.
struct TouchReport {
  std::size_t points = 0;
  std::string gpu;
  double build_us = 0;
  TraceSummary trace;
  Summary edit_us;
  std::uint64_t skippedEdits = 0;
  std::size_t movedPoints = 0;      ///< that lie elsewhere than in the file
  double contactError_mm = 0;       ///< see contactError_mm()
  std::size_t contactErrorTicks = 0;
  bool realtimePriority = false;
  bool realtime = false;
  bool edits = false;
};

/// Largest distance of the proxy from the surface that double precision finds on the CPU, over up to 200 ticks in contact
/// from before the first edit, mm; and how many ticks were looked at.
struct ContactError {
  double worst_mm = 0;
  std::size_t ticks = 0;
};
ContactError contactError(const Trace& trace, const Model& model, double radius, std::size_t firstEdit);

void printReport(std::FILE* out, const TouchReport& report);
Json toJson(const TouchReport& report);

}  // namespace palpate
