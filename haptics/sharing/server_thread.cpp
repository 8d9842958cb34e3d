#include "haptics/sharing/server_thread.hpp"

#include "engine/core/start_thread.hpp"

namespace palpate {

ServerThread::ServerThread(const PointCloud& cloud, CloudServer::Parts parts)
    : server_(cloud, std::move(parts)), thread_(startThread([this] { run(); })) {}

void ServerThread::run() {
  std::exception_ptr failure;
  std::unique_lock hold(lock_);
  while (!stop_ && !failure) {
    atRest_ = false;
    pause_ = looking_ > 0;
    hold.unlock();
    try {
      server_.serve(pause_);
    } catch (...) {
      failure = std::current_exception();
    }
    hold.lock();
    atRest_ = true;
    changed_.notify_all();
    changed_.wait(hold, [&] { return looking_ == 0; });
  }
  atRest_ = true;
  failure_ = failure;
  isServing_ = false;
  changed_.notify_all();  // wakes waiting threads that the last round has not woken
}

void ServerThread::stop() {
  {
    const std::scoped_lock hold(lock_);
    stop_ = pause_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

void ServerThread::check() const {
  const std::scoped_lock hold(lock_);
  if (failure_) std::rethrow_exception(failure_);
}

template <class Look>
auto ServerThread::atRest(Look&& look) {
  std::unique_lock hold(lock_);
  struct Looking {
    explicit Looking(ServerThread& server) : of(server) { ++of.looking_; }
    ~Looking() {
      --of.looking_;
      of.changed_.notify_all();
    }
    ServerThread& of;
  } const looking(*this);
  pause_ = true;
  changed_.wait(hold, [&] { return atRest_; });
  return look();
}

ServedCounts ServerThread::counts() {
  return atRest([&] { return server_.counts(); });
}

std::vector<PointState> ServerThread::points() {
  return atRest([&] {
    const std::span<const PointState> points = server_.points();
    return std::vector<PointState>(points.begin(), points.end());
  });
}

}  // namespace palpate
