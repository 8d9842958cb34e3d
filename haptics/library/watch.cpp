#include "haptics/library/watch.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>

#include "engine/core/start_thread.hpp"

namespace palpate::library {

void Watch::run(const std::function<void()>& act) {
  if (!watch_.stop && !watch_.progress) return act();
  constexpr std::chrono::milliseconds kBetween{20};
  stop_ = false;
  forget();
  std::exception_ptr failure;
  std::mutex lock;
  std::condition_variable ended;
  bool isOver = false;
  std::jthread job = startThread([&] {
    const JobStopScope stops({.flag = &stop_});
    try {
      act();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::scoped_lock held(lock);
    isOver = true;
    ended.notify_all();
  });
  for (std::unique_lock held(lock); !ended.wait_for(held, kBetween, [&] { return isOver; });) {
    held.unlock();
    tell();
    if (watch_.stop && !stop_ && watch_.stop(watch_.user) != 0) stop_ = true;
    held.lock();
  }
  job.join();
  if (failure) std::rethrow_exception(failure);
  tell();
}

void Watch::progressed(std::string_view what, double share) {
  if (!isTold()) return;
  const std::scoped_lock held(lock_);
  what_ = what;
  share_ = share;
  isNew_ = true;
}

void Watch::forget() {
  const std::scoped_lock held(lock_);
  isNew_ = false;
}

void Watch::tell() {
  if (!isTold()) return;
  std::unique_lock held(lock_);
  if (!std::exchange(isNew_, false)) return;
  const std::string what = what_;
  const double share = share_;
  held.unlock();
  watch_.progress(watch_.user, what.c_str(), share);
}

}  // namespace palpate::library
