#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

#include "engine/core/job_stop.hpp"

namespace palpate {

/// A persistent thread pool for repeated parallel work: starting a job creates no threads and does not allocate. Used
/// by one thread at a time, which takes part itself, and never waits for a thread that has not begun a part: where the
/// others wake late it does all the work. Between jobs the others spin for 20 us before they sleep.
class WorkerTeam {
 public:
  /// `threads`: including the caller; 0: one per core.
  explicit WorkerTeam(unsigned threads);
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  /// Number of threads, including the caller.
  std::size_t size() const { return workers_.size() + 1; }

  /// Calls body(part) once for every part in [0, parts), on any free thread, and returns when all are done. `body` must
  /// not throw. Throws Stopped with parts left undone.
  template <class Body>
  void forEach(std::size_t parts, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    run(
        parts, [](void* context, std::size_t part) { (*static_cast<Plain*>(context))(part); }, std::addressof(body));
  }

 private:
  using Call = void (*)(void* context, std::size_t part);
  void run(std::size_t parts, Call call, void* context);
  void work();
  void takeParts();
  template <class Done>
  static void spinUntil(Done&& done);

  std::mutex lock_;
  std::condition_variable wake_, idle_;
  std::atomic<std::size_t> turn_ = 0;  // incremented by every job
  std::atomic<std::size_t> busy_ = 0;  // workers that take parts of this job
  bool isOpen_ = false;                // workers may still join this job
  std::atomic<bool> stop_ = false;
  std::size_t parts_ = 0;
  std::atomic<std::size_t> next_ = 0;
  Call call_ = nullptr;
  void* context_ = nullptr;
  JobStop stopsBy_;  // stop request of the caller
  std::vector<std::jthread> workers_;
};

}  // namespace palpate
