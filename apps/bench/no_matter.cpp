// Replaces matter.cpp if palpate is built without PALPATE_SIMULATION.
#include <CLI/CLI.hpp>

#include "apps/bench/bench.hpp"
#include "engine/core/error.hpp"

namespace palpate {

void listMatterBenchResults(std::vector<ResultFacts>&) {}

void addMatterBench(Options& bench, Context&, Command& command) {
  Options& sub = bench.addSubcommand("matter",
                                     "a millisecond of matter; this palpate was built without "
                                     "PALPATE_SIMULATION");
  sub.app().fallthrough(false)->allow_extras();  // the error is the same for every option
  sub.whenNamed([&command] { command = [] { throw NotBuilt("bench matter", "PALPATE_SIMULATION"); }; });
}

}  // namespace palpate
