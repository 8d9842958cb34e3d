// The record of a session, tick by tick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/statistics.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// One tick. Positions in model units, in the coordinates of the model's file.
struct TraceRow {
  double time_s = 0;
  DVec3 hip{0};
  DVec3 proxy{0};   ///< the HIP if nothing is touched
  DVec3 normal{0};  ///< unit, outward; zero if no surface was in reach
  DVec3 force_N{0};
  DVec3 torque_mNm{0};        ///< of a tool of many points or a ball in matter, about the HIP; reported, not rendered
  double penetration_mm = 0;  ///< from HIP to proxy; 0 if nothing is touched
  bool contact = false;
  bool fresh = false;        ///< from this tick's own query
  bool valid = false;        ///< false: the query or the device failed at this tick
  bool withheld = false;     ///< HandForce::isWithheld()
  bool hot = false;          ///< ForceGate::isHot()
  bool putDown = false;      ///< the stylus was lifted before this tick, and put down elsewhere
  std::uint32_t missed = 0;  ///< ticks before it that came too late
  std::uint32_t neighbours = 0;
  bool forcesOn = true;  ///< the user wanted forces (ServoOptions::forcesOn)
  double age_s = -1;     ///< dataAge_s() of its contact
  double gpu_us = 0;     ///< 0 if it was not measured
  double step_us = 0;    ///< from pose read to force computed
};

struct Trace {
  std::vector<TraceRow> rows;
  bool virtualTime = true;
  bool torques = false;           ///< the tool had many points: a row's contact stands for all (ContactQuery::points)
  std::uint64_t missedTicks = 0;  ///< skipped because their time had passed
};

struct TraceSummary {
  std::uint64_t ticks = 0;
  std::uint64_t contactTicks = 0;
  std::uint64_t missedTicks = 0;
  std::uint64_t faultTicks = 0;  ///< with a failed query or device
  Summary step_us;
  Summary gpu_us;  ///< of the ticks at which it was measured
  double freshFraction = 0;
  double peakForce_N = 0;
  double peakTorque_mNm = 0;
};

TraceSummary summarize(const Trace& trace);
/// From the first tick to the last one, s.
inline double durationOf(const Trace& trace) {
  return trace.rows.empty() ? 0 : trace.rows.back().time_s - trace.rows.front().time_s;
}

/// A column of a trace file.
struct TraceColumn {
  std::string_view name, unit, meaning;
};
/// All columns; the last three are those of torques.
std::span<const TraceColumn> traceColumns();

/// One row per tick, numbers in the shortest form that reads back to the same double. In virtual time gpu_us and
/// step_us are written as 0, so that the same input gives the same bytes; their statistics are in the summary. With a
/// tool of many points three more columns follow: torque_x, torque_y, torque_z, mN m. Throws FileError.
void writeTraceCsv(const std::filesystem::path& file, const Trace& trace);

}  // namespace palpate
