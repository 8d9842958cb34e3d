// What a limit of threads does to those who start some: an error in words, and no hang.
#include "tests/few_threads_linux.hpp"

#include <doctest/doctest.h>

#include "engine/core/background_task.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/worker_team.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"

namespace palpate::few_threads_test {

TEST_CASE("where the system starts no more threads, parallel work is an error that says so, and does not hang") {
  if (!kThreadsCanBeFew) {
    MESSAGE("skipped: a sanitizer starts the threads");
    return;
  }
  for (const int more : {0, 1, 3}) {
    CAPTURE(more);
    const auto complains = [&](auto&& act) {
      std::string complaint;
      {
        const FewThreads few(more);
        complaint = errorOf(act);
      }
      CHECK(says(complaint, "the system does not start another thread"));
      CHECK(says(complaint, "raise the limit of threads (ulimit -u)"));
    };
    complains([] { const WorkerTeam team(6); });
    complains([] { parallelFor(100'000, 6, [](std::size_t, std::size_t) {}); });
    if (more == 0) complains([] { const BackgroundTask task([] {}); });
  }
  WorkerTeam(6).forEach(10, [](std::size_t) {});
}

}  // namespace palpate::few_threads_test
