// Benches that measure times alone and can be asked for together, in one set of tables and one plot: build, sort, query
// and step.
#pragma once

#include "apps/bench/bench.hpp"

namespace palpate {

class CommandList;

struct TimeBenchOptions : BenchOptions {
  std::vector<std::string> surfaces{"average"};  ///< of query and step; every back end has the average
  std::vector<std::int64_t> toolPoints;          ///< of step: a tool of so many points is measured, too, for each
  std::string tool = "pad";
  double toolSize_mm = ToolConfig{}.size_mm;
  double movedShare = 0.01;
};

/// One measurement: so many repetitions of one way to do a job on one subject.
struct BenchRecord {
  std::string bench;    ///< build, sort, query or step
  std::string backend;  ///< vulkan, cuda or cpu
  std::string way;      ///< the sort or the query method
  std::string input;    ///< what was done: "file order", "last order", "static", "edited", …
  std::string subject;
  std::size_t points = 0;
  Summary gpu_us;   ///< time on the GPU; no samples where it was not measured
  Summary wall_us;  ///< time on the CPU's clock; no samples where it was not measured
};

/// What one section of a list takes on the GPU, us, once the list has run before.
Summary measureSection(Device& device, const CommandList& list, std::string_view section, const BenchOptions& options);

/// Each adds what it has measured.
void benchBuild(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records);
void benchSort(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records);
void benchQuery(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records);
void benchStep(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records);

}  // namespace palpate
