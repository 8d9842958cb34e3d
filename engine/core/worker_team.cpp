#include "engine/core/worker_team.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/start_thread.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

// Jobs often follow each other within microseconds, in which a thread would not even fall asleep.
constexpr double kSpin_us = 20, kBurstSpin_us = 100;
// A thread wakes so many others, which wake so many in turn: to wake one takes a microsecond or two of the one that
// wakes it, and some tens until it runs, more on a virtual machine.
constexpr std::size_t kWakes = 16;

// For the other thread of a core.
void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

template <class Done>
bool spinUntil(double most_us, Done&& done) {
  const Stopwatch watch;
  while (!done()) {
    if (watch.elapsed_us() > most_us) return false;
    relax();
  }
  return true;
}

}  // namespace

WorkerTeam::WorkerTeam(unsigned threads) {
  const unsigned count = threadCount(threads);
  for (unsigned i = 1; i < count; ++i) workers_.push_back(std::make_unique<Worker>());
  try {
    for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i]->thread = startThread([this, i] { work(i); });
  } catch (...) {
    end();  // those that have started wait for a job
    throw;
  }
}

WorkerTeam::~WorkerTeam() { end(); }

void WorkerTeam::end() {
  stop_ = true;
  for (const std::unique_ptr<Worker>& worker : workers_)
    if (worker->asleep.exchange(false)) worker->bell.post();
}

WorkerTeam::Burst::Burst(WorkerTeam& team) : team_(team) {
  team.called_ = 0;
  team.inBurst_ = true;
}

std::size_t WorkerTeam::Burst::engage(std::size_t threads) {
  const std::size_t engaged = std::clamp<std::size_t>(threads, 1, team_.size());
  team_.called_ = engaged - 1;
  team_.ring(0, kWakes);
  return engaged;
}

WorkerTeam::Burst::~Burst() { team_.inBurst_ = false; }

// Those of these workers that are called and asleep.
void WorkerTeam::ring(std::size_t first, std::size_t count) {
  const std::size_t end = std::min(first + count, called_.load());
  for (std::size_t i = first; i < end; ++i)
    if (workers_[i]->asleep.exchange(false)) workers_[i]->bell.post();
}

void WorkerTeam::run(std::size_t parts, Call call, void* context) {
  if (!inBurst_) called_ = std::min(parts, size()) - std::min<std::size_t>(parts, 1);
  if (parts <= 1 || called_ == 0) {
    for (std::size_t part = 0; part < parts; ++part) {
      throwIfStopWanted();
      call(context, part);
    }
    return;
  }
  parts_ = parts;
  call_ = call;
  context_ = context;
  stopsBy_ = jobStop;
  next_ = 0;
  state_ = (jobOf(state_) + 1) * kJob + kOpen;
  ring(0, kWakes);
  {
    const JobStopScope whole(JobStopScope::whole());  // for each part
    takeParts();
  }
  state_ -= kOpen;
  if (!spinUntil(inBurst_ ? kBurstSpin_us : kSpin_us, [this] { return (state_ & kBusy) == 0; }))
    for (std::uint32_t state = state_; (state & kBusy) != 0; state = state_) state_.wait(state);
  if (failed_.exchange(false)) std::rethrow_exception(std::exchange(failure_, nullptr));
  throwIfStopWanted();
}

// A job later than `seen` that this worker may join, or the end.
bool WorkerTeam::hasNews(std::size_t worker, std::uint32_t seen) const {
  const std::uint32_t state = state_;
  return stop_ || (jobOf(state) != seen && (state & kOpen) != 0 && worker < called_);
}

// Sleeps, unless there are news.
void WorkerTeam::rest(std::size_t worker, std::uint32_t seen) {
  Worker& self = *workers_[worker];
  self.asleep = true;
  if (!hasNews(worker, seen) || !self.asleep.exchange(false)) self.bell.take();
}

void WorkerTeam::work(std::size_t worker) {
  giveWay();  // work of a team is not urgent
  std::uint32_t seen = 0;
  while (!stop_) {
    const auto isAwaited = [&] { return inBurst_ && worker < called_; };
    const bool awaited = isAwaited();
    if (!spinUntil(awaited ? kBurstSpin_us : kSpin_us, [&] { return hasNews(worker, seen) || isAwaited() != awaited; }))
      rest(worker, seen);
    if (worker < called_) ring(kWakes * (worker + 1), kWakes);
    if (hasNews(worker, seen)) takePartsAfter(seen);
  }
}

// The caller waits for a worker that has joined its job.
void WorkerTeam::takePartsAfter(std::uint32_t& seen) {
  std::uint32_t state = state_;
  do {
    if ((state & kOpen) == 0) return;
  } while (!state_.compare_exchange_weak(state, state + 1));
  seen = jobOf(state);
  takeParts();
  if ((--state_ & (kBusy | kOpen)) == 0) state_.notify_one();
}

void WorkerTeam::takeParts() {
  try {
    for (std::size_t part; (part = next_++) < parts_;)
      if (!(stopsBy_.mayCut && isStopWanted(stopsBy_))) call_(context_, part);
  } catch (...) {
    if (!failed_.exchange(true)) failure_ = std::current_exception();
    next_ = parts_;  // no thread begins another part
  }
}

}  // namespace palpate
