#include "engine/core/worker_team.hpp"

#include "engine/core/clock.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

// Jobs often follow each other within microseconds, in which a thread would not even fall asleep.
template <class Done>
void WorkerTeam::spinUntil(Done&& done) {
  constexpr double kSpin_us = 20;
  const Stopwatch watch;
  while (!done() && watch.elapsed_us() < kSpin_us) {
  }
}

WorkerTeam::WorkerTeam(unsigned threads) {
  for (unsigned i = 1; i < threadCount(threads); ++i) workers_.emplace_back([this] { work(); });
}

WorkerTeam::~WorkerTeam() {
  {
    const std::scoped_lock hold(lock_);
    stop_ = true;
  }
  wake_.notify_all();
}

void WorkerTeam::run(std::size_t parts, Call call, void* context) {
  if (parts <= 1 || workers_.empty()) {
    for (std::size_t part = 0; part < parts; ++part) {
      throwIfStopWanted();
      call(context, part);
    }
    return;
  }
  {
    const std::scoped_lock hold(lock_);
    parts_ = parts;
    call_ = call;
    context_ = context;
    stopsBy_ = jobStop;
    next_ = 0;
    isOpen_ = true;
    ++turn_;
  }
  if (parts <= workers_.size())
    for (std::size_t part = 1; part < parts; ++part) wake_.notify_one();
  else
    wake_.notify_all();
  {
    const JobStopScope whole(JobStopScope::whole());  // for each part
    takeParts();
  }
  std::unique_lock hold(lock_);
  isOpen_ = false;
  if (busy_ > 0) {
    hold.unlock();
    spinUntil([this] { return busy_ == 0; });
    hold.lock();
  }
  idle_.wait(hold, [this] { return busy_ == 0; });
  throwIfStopWanted();
}

void WorkerTeam::work() {
  giveWay();  // work of a team is not urgent
  std::size_t done = 0;
  std::unique_lock hold(lock_);
  while (true) {
    hold.unlock();
    spinUntil([&] { return turn_ != done || stop_; });
    hold.lock();
    wake_.wait(hold, [&] { return stop_ || (isOpen_ && turn_ != done); });
    if (stop_) return;
    done = turn_;
    ++busy_;
    hold.unlock();
    takeParts();
    hold.lock();
    if (--busy_ == 0) idle_.notify_one();
  }
}

void WorkerTeam::takeParts() {
  for (std::size_t part; (part = next_++) < parts_;)
    if (!(stopsBy_.mayCut && isStopWanted(stopsBy_))) call_(context_, part);
}

}  // namespace palpate
