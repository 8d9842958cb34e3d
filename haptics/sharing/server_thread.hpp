// A cloud that is served on a thread of its own, for a program that does something else meanwhile.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

/// For any number of threads, but that one of them alone ends it.
class ServerThread {
 public:
  /// Serves at once, as CloudServer does, and throws as that does.
  ServerThread(const PointCloud& cloud, CloudServer::Parts parts);
  ~ServerThread() { stop(); }
  ServerThread(const ServerThread&) = delete;
  ServerThread& operator=(const ServerThread&) = delete;

  /// Nobody is answered from then on. Not on the server's own thread, as a listener of its log is.
  void stop();
  /// False once it has been stopped, or has ended by itself: check() says why.
  bool isServing() const { return isServing_; }
  /// Throws what has ended it.
  void check() const;
  ServedCounts counts();
  /// By id, as they are.
  std::vector<PointState> points();

 private:
  void run();
  // With the server at rest, which takes as long as it needs to look up.
  template <class Look>
  auto atRest(Look&& look);

  CloudServer server_;
  std::atomic<bool> pause_ = false, isServing_ = true;
  mutable std::mutex lock_;  // of what follows
  std::condition_variable changed_;
  int looking_ = 0;  // threads that look, or want to
  bool atRest_ = false, stop_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
