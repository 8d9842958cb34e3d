// A cloud that one machine serves, and others join: they get its points, bit by bit, and feel and draw them as their own.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

/// How much was handed out.
struct ServedCounts {
  std::uint64_t clients = 0;  ///< that have ever asked for points
  std::uint64_t requests = 0, blocks = 0, pings = 0;
  std::uint64_t refused = 0;  ///< requests that no client of ours makes
};

/// Serves a cloud that stands still. Reads it from one thread; nothing of it is written.
class CloudServer {
 public:
  struct Parts {
    NetworkConfig network;
    std::string name;   ///< by which it is joined
    std::string model;  ///< what the points are, in words
    double mm_per_unit = 1;
    Log* log = nullptr;  ///< hears of who comes; outlives this
  };
  /// `cloud` has normals, and outlives this. Throws UsageError for a name that cannot be, NetworkError where a session of that
  /// name is served already, or nothing can be.
  CloudServer(const PointCloud& cloud, Parts parts);
  ~CloudServer();
  CloudServer(const CloudServer&) = delete;
  CloudServer& operator=(const CloudServer&) = delete;

  /// Answers until `stop` is true, or `seconds` have passed, where they are more than 0. Throws NetworkError.
  void serve(const std::atomic<bool>& stop, double seconds = 0);
  ServedCounts counts() const;

 private:
  struct Link;
  std::unique_ptr<Link> link_;
};

struct JoinedCloud {
  PointCloud cloud;
  double mm_per_unit = 0;
  std::string host, model;
};

struct JoinOptions {
  NetworkConfig network;
  double patience_s = 10;  ///< for the session to be found, and for each next piece of it
  Log* log = nullptr;      ///< hears how far it has come; outlives the call
  const std::atomic<bool>* stop = nullptr;  ///< ends it when it becomes true
};

/// The points of the session of that name, as they are served. Takes memory as they come, and no more for what is only
/// announced. Throws NetworkError where there is none, or two of that name, or one of another version, or its points are
/// none, or not those that it announced.
JoinedCloud joinCloud(const std::string& name, const JoinOptions& options);

}  // namespace palpate
