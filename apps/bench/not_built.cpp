// Replaces the benches if palpate is built without PALPATE_STUDY.
#include <CLI/CLI.hpp>

#include "apps/cli/context.hpp"
#include "apps/cli/results.hpp"
#include "engine/core/error.hpp"

namespace palpate {

void listBenchResults(std::vector<ResultFacts>&) {}

void addBench(Options& app, Context&, Command& command) {
  Options& sub = app.addSubcommand("bench", "measure on this machine; this palpate was built without PALPATE_STUDY");
  sub.app().fallthrough(false)->allow_extras();  // the error is the same for every bench and its options
  sub.whenNamed([&command] {
    command = [] {
      throw UsageError(
          "bench needs PALPATE_STUDY, which this palpate was built without; build it again with -DPALPATE_STUDY=ON");
    };
  });
}

}  // namespace palpate
