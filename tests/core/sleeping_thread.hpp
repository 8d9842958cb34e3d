#pragma once

#include <future>
#include <thread>

namespace palpate {

/// A sleeping thread for tests to inspect, with its system identifier from `ownNumber`.
template <auto ownNumber>
class SleepingThread {
 public:
  SleepingThread()
      : thread_([this] {
          running_.set_value(ownNumber());
          done_.get_future().wait();
        }),
        number_(running_.get_future().get()) {}
  ~SleepingThread() {
    done_.set_value();
    thread_.join();
  }
  SleepingThread(const SleepingThread&) = delete;
  SleepingThread& operator=(const SleepingThread&) = delete;

  auto number() const { return number_; }

 private:
  using Number = decltype(ownNumber());

  std::promise<Number> running_;
  std::promise<void> done_;
  std::thread thread_;
  Number number_;
};

}  // namespace palpate
