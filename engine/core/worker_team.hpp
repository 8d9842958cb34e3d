#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>
#include <type_traits>
#include <vector>

#include "engine/core/job_stop.hpp"
#include "engine/core/semaphore.hpp"

namespace palpate {

/// A persistent thread pool for repeated parallel work: starting a job creates no threads, does not allocate and takes
/// no lock. Used by one thread at a time, which takes part itself, and never waits for a thread that has not begun a
/// part: where the others wake late it does all the work. Between jobs the others spin for 20 us before they sleep.
class WorkerTeam {
 public:
  /// `threads`: including the caller; 0: one per core.
  explicit WorkerTeam(unsigned threads);
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  /// Number of threads, including the caller.
  std::size_t size() const { return workers_.size() + 1; }

  /// Calls body(part) once for every part in [0, parts), on any free thread, and returns when all are done. Throws
  /// Stopped, and what `body` throws, with parts left undone.
  template <class Body>
  void forEach(std::size_t parts, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    run(
        parts, [](void* context, std::size_t part) { (*static_cast<Plain*>(context))(part); }, std::addressof(body));
  }

  /// Jobs that follow each other soon, while it lives: only the engaged threads take part, which spin between the jobs
  /// for as long as 100 us.
  class Burst {
   public:
    /// Engages the caller alone.
    explicit Burst(WorkerTeam& team);
    ~Burst();
    Burst(const Burst&) = delete;
    Burst& operator=(const Burst&) = delete;
    /// From the next job on, `threads` take part, including the caller: as many as the work is worth. Wakes them at
    /// once. Returns how many are engaged.
    std::size_t engage(std::size_t threads);

   private:
    WorkerTeam& team_;
  };

 private:
  using Call = void (*)(void* context, std::size_t part);
  struct alignas(64) Worker {
    std::atomic<bool> asleep = false;
    Semaphore bell;
    std::jthread thread;
  };
  // The number of the job, whether workers may still join it, and how many of them take parts.
  static constexpr std::uint32_t kBusy = 0xffff, kOpen = kBusy + 1, kJob = 2 * kOpen;

  void end();
  void run(std::size_t parts, Call call, void* context);
  void work(std::size_t worker);
  void rest(std::size_t worker, std::uint32_t seen);
  void takePartsAfter(std::uint32_t& seen);
  void ring(std::size_t first, std::size_t count);
  void takeParts();
  bool hasNews(std::size_t worker, std::uint32_t seen) const;
  static std::uint32_t jobOf(std::uint32_t state) { return state / kJob; }

  std::atomic<std::uint32_t> state_ = 0;
  std::atomic<std::size_t> called_ = 0;  // so many workers, the first ones, take part
  std::atomic<bool> inBurst_ = false, stop_ = false;
  std::size_t parts_ = 0;
  alignas(64) std::atomic<std::size_t> next_ = 0;
  Call call_ = nullptr;
  void* context_ = nullptr;
  JobStop stopsBy_;  // stop request of the caller
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;  // the first one
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace palpate
