#include "haptics/trace.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "engine/core/error.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::trace_test {
namespace {

const std::string kHeader =
    "t_s,hip_x,hip_y,hip_z,proxy_x,proxy_y,proxy_z,normal_x,normal_y,normal_z,force_x,force_y,force_z,penetration_mm,"
    "contact,neighbours,fresh,gpu_us,step_us\n";

Trace twoTicks() {
  TraceRow free{.time_s = 0, .hip = {1, -0.0, 0.1}, .proxy = {1, -0.0, 0.1}, .valid = true, .step_us = 4};
  TraceRow touching{.time_s = 0.001,
                    .hip = {1e6 + 0.125, 0, -1e-7},
                    .proxy = {1, 0, 0},
                    .normal = {0, 0, 1},
                    .force_N = {0, -3, 4},
                    .penetration_mm = 2,
                    .contact = true,
                    .fresh = true,
                    .valid = true,
                    .neighbours = 31,
                    .gpu_us = 12.5,
                    .step_us = 40.25};
  return {.rows = {free, touching}, .missedTicks = 3};
}

}  // namespace

TEST_CASE("a trace in virtual time is written without wall-clock times and without minus zero") {
  const ScratchFolder folder;
  writeTraceCsv(folder / "trace.csv", twoTicks());
  CHECK(contentOf(folder / "trace.csv") == kHeader + "0,1,0,0.1,1,0,0.1,0,0,0,0,0,0,0,0,0,0,0,0\n" +
                                               "0.001,1000000.125,0,-1e-07,1,0,0,0,0,1,0,-3,4,2,1,31,1,0,0\n");
}

TEST_CASE("the trace of a tool of many points has its torques at the end") {
  const ScratchFolder folder;
  Trace trace = twoTicks();
  trace.torques = true;
  trace.rows[1].torque_mNm = {0.5, -0.0, -2};
  writeTraceCsv(folder / "trace.csv", trace);
  CHECK(contentOf(folder / "trace.csv") == kHeader.substr(0, kHeader.size() - 1) + ",torque_x,torque_y,torque_z\n" +
                                               "0,1,0,0.1,1,0,0.1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n" +
                                               "0.001,1000000.125,0,-1e-07,1,0,0,0,0,1,0,-3,4,2,1,31,1,0,0,0.5,0,-2\n");
  CHECK(summarize(trace).peakTorque_mNm == near(std::sqrt(4.25), 1e-6));
}

TEST_CASE("a trace in real time is written with wall-clock times") {
  const ScratchFolder folder;
  Trace trace = twoTicks();
  trace.virtualTime = false;
  writeTraceCsv(folder / "trace.csv", trace);
  CHECK(contentOf(folder / "trace.csv").ends_with(",1,31,1,12.5,40.25\n"));
}

TEST_CASE("a trace longer than the write buffer is complete, and an empty one is its header") {
  const ScratchFolder folder;
  Trace trace;
  writeTraceCsv(folder / "trace.csv", trace);
  CHECK(contentOf(folder / "trace.csv") == kHeader);
  trace.rows.resize(5000);
  writeTraceCsv(folder / "trace.csv", trace);
  const std::string text = contentOf(folder / "trace.csv");
  CHECK(std::count(text.begin(), text.end(), '\n') == 5001);
}

TEST_CASE("a trace that cannot be written is an error") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(writeTraceCsv(folder / "no" / "such" / "trace.csv", twoTicks()), FileError);
}

TEST_CASE("the trace summary counts ticks, contact and times") {
  const TraceSummary summary = summarize(twoTicks());
  CHECK(summary.ticks == 2);
  CHECK(summary.contactTicks == 1);
  CHECK(summary.missedTicks == 3);
  CHECK(summary.faultTicks == 0);
  CHECK(summary.freshFraction == 0.5);
  CHECK(summary.peakForce_N == near(5, 1e-6));
  CHECK(summary.step_us.count == 2);
  CHECK(summary.step_us.max == 40.25);
  CHECK(summary.gpu_us.count == 1);
  CHECK(summary.gpu_us.p50 == 12.5);
  CHECK(summarize(Trace{}).freshFraction == 0);
}

}  // namespace palpate::trace_test
