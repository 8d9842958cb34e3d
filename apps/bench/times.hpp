// Benches that only measure times and can be combined in one set of tables and one plot: build, sort, query and step.
#pragma once

#include "apps/bench/bench.hpp"

namespace palpate {

class CommandList;

struct TimeBenchOptions : BenchOptions {
  std::vector<std::string> surfaces{"average"};  ///< for query and step; every back end has the average
  std::vector<std::int64_t> toolPoints;          ///< for step: sizes of tools that are also measured
  std::string tool = "pad";
  double toolSize_mm = ToolConfig{}.size_mm;
  double movedShare = 0.01;
};

/// One measurement: the repetitions of one method for a job on one subject.
struct BenchRecord {
  std::string bench;    ///< build, sort, query or step
  std::string backend;  ///< vulkan, cuda or cpu
  std::string way;      ///< the sort or the query method
  std::string input;    ///< variant of the job: "file order", "last order", "static", "edited", …
  std::string subject;
  std::size_t points = 0;
  Summary gpu_us;   ///< time on the GPU; no samples where it was not measured
  Summary wall_us;  ///< time on the CPU's clock; no samples where it was not measured
};

/// GPU time of one section of a list, us, after the list has run once.
Summary measureSection(Device& device, const CommandList& list, std::string_view section, const BenchOptions& options);

/// Each appends its measurements.
void benchBuild(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records);
void benchSort(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records);
void benchQuery(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records);
void benchStep(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records);

}  // namespace palpate
