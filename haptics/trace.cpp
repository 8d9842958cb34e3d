#include "haptics/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "engine/core/atomic_file.hpp"

namespace palpate {
namespace {

constexpr std::string_view kTraceHeader =
    "t_s,hip_x,hip_y,hip_z,proxy_x,proxy_y,proxy_z,normal_x,normal_y,normal_z,force_x,force_y,force_z,penetration_mm,"
    "contact,neighbours,fresh,gpu_us,step_us";
constexpr std::string_view kTorques = ",torque_x,torque_y,torque_z";
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
  for (const std::string_view part : {kTraceHeader, trace.torques ? kTorques : "", std::string_view("\n")})
    text.append(part);
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
