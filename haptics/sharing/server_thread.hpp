// Serves a cloud on a thread of its own, for a program that does something else meanwhile.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

/// Thread-safe, but only one thread may end it.
class ServerThread {
 public:
  /// Starts serving, as CloudServer does, and throws as that does.
  ServerThread(const PointCloud& cloud, CloudServer::Parts parts);
  ~ServerThread() { stop(); }
  ServerThread(const ServerThread&) = delete;
  ServerThread& operator=(const ServerThread&) = delete;

  /// Ends serving. Must not be called on the server's own thread, as by a listener of its log.
  void stop();
  /// False after stop() or a failure; check() throws the failure.
  bool isServing() const { return isServing_; }
  /// Rethrows the failure that has ended it.
  void check() const;
  ServedCounts counts();
  /// Current points, by id.
  std::vector<PointState> points();

 private:
  void run();
  // Calls `look` while the server is paused; first waits until it has paused.
  template <class Look>
  auto atRest(Look&& look);

  CloudServer server_;
  std::atomic<bool> pause_ = false, isServing_ = true;
  mutable std::mutex lock_;  // guards the members below
  std::condition_variable changed_;
  int looking_ = 0;  // threads that look or wait to look
  bool atRest_ = false, stop_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
