#include "haptics/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/core/atomic_file.hpp"

namespace palpate {
namespace {

constexpr TraceColumn kColumns[]{
    {"t_s", "s", "time of the session"},
    {"hip_x", "model units", "device position"},
    {"hip_y", "model units", "likewise"},
    {"hip_z", "model units", "likewise"},
    {"proxy_x", "model units", "position on the surface; the HIP if nothing is touched"},
    {"proxy_y", "model units", "likewise"},
    {"proxy_z", "model units", "likewise"},
    {"normal_x", "1", "unit normal of the surface, outward; zero if none was in reach"},
    {"normal_y", "1", "likewise"},
    {"normal_z", "1", "likewise"},
    {"force_x", "N", "force on the hand"},
    {"force_y", "N", "likewise"},
    {"force_z", "N", "likewise"},
    {"penetration_mm", "mm", "distance from HIP to proxy; 0 if nothing is touched"},
    {"contact", "", "1: in contact"},
    {"neighbours", "", "points that defined the surface"},
    {"fresh", "", "1: answer to the pose of this tick"},
    {"gpu_us", "us", "time on the GPU; 0 in virtual time"},
    {"step_us", "us", "time from pose read to force ready; 0 in virtual time"},
    {"torque_x", "mN m", "torque about the HIP; only with a tool of many points and in matter"},
    {"torque_y", "mN m", "likewise"},
    {"torque_z", "mN m", "likewise"},
};
constexpr std::size_t kTorques = 3;                   // the last columns
constexpr std::size_t kChunk = std::size_t{1} << 16;  // bytes per write to the file

/// Adding zero turns -0 into 0 and changes nothing else.
double plain(double value) { return value + 0.0; }

void append(fmt::memory_buffer& text, const DVec3& v) {
  fmt::format_to(std::back_inserter(text), "{},{},{},", plain(v.x), plain(v.y), plain(v.z));
}

void append(fmt::memory_buffer& text, const TraceRow& row, bool withTimes, bool withTorques) {
  fmt::format_to(std::back_inserter(text), "{},", plain(row.time_s));
  for (const DVec3& v : {row.hip, row.proxy, row.normal, row.force_N}) append(text, v);
  fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}", plain(row.penetration_mm), int{row.contact},
                 row.neighbours, int{row.fresh}, withTimes ? plain(row.gpu_us) : 0.0,
                 withTimes ? plain(row.step_us) : 0.0);
  if (withTorques)
    fmt::format_to(std::back_inserter(text), ",{},{},{}", plain(row.torque_mNm.x), plain(row.torque_mNm.y),
                   plain(row.torque_mNm.z));
  text.push_back('\n');
}

}  // namespace

std::span<const TraceColumn> traceColumns() { return kColumns; }

TraceSummary summarize(const Trace& trace) {
  TraceSummary summary{.ticks = trace.rows.size(), .missedTicks = trace.missedTicks};
  std::vector<double> steps_us, gpus_us;
  steps_us.reserve(trace.rows.size());
  std::uint64_t freshTicks = 0;
  for (const TraceRow& row : trace.rows) {
    summary.contactTicks += row.contact;
    summary.faultTicks += !row.valid;
    freshTicks += row.fresh;
    summary.peakForce_N = std::max(summary.peakForce_N, glm::length(row.force_N));
    summary.peakTorque_mNm = std::max(summary.peakTorque_mNm, glm::length(row.torque_mNm));
    steps_us.push_back(row.step_us);
    if (row.gpu_us > 0) gpus_us.push_back(row.gpu_us);
  }
  if (summary.ticks) summary.freshFraction = static_cast<double>(freshTicks) / static_cast<double>(summary.ticks);
  summary.step_us = summarize(std::move(steps_us));
  summary.gpu_us = summarize(std::move(gpus_us));
  return summary;
}

void writeTraceCsv(const std::filesystem::path& file, const Trace& trace) {
  AtomicFile out(file);
  fmt::memory_buffer text;
  const auto columns = trace.torques ? traceColumns() : traceColumns().first(std::size(kColumns) - kTorques);
  for (const TraceColumn& column : columns) {
    text.append(column.name);
    text.push_back(&column == &columns.back() ? '\n' : ',');
  }
  for (const TraceRow& row : trace.rows) {
    append(text, row, !trace.virtualTime, trace.torques);
    if (text.size() < kChunk) continue;
    out.write(std::string_view(text.data(), text.size()));
    text.clear();
  }
  out.write(std::string_view(text.data(), text.size()));
  out.commit();
}

}  // namespace palpate
