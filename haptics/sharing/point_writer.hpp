// Writes the served points to the server's file when clients ask.
#pragma once

#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

/// One write at a time, on a thread of its own, and one every five seconds at most, however many requests there are:
/// all of them until a write begins are answered by it. For one thread.
class PointWriter {
 public:
  struct Parts {
    const PointCloud& cloud;     ///< as served
    const SharedPoints& points;  ///< as edited since
    SaveFunction save;           ///< empty: there is no file, and all requests are refused
    Log* log = nullptr;          ///< logs each write
  };
  /// All that `parts` refers to must outlive it. Its destructor waits for a write in progress.
  explicit PointWriter(Parts parts) : parts_(std::move(parts)) {}

  /// Takes the request of a ping, and completes its echo.
  void answer(Ping& ping);
  /// Begins and ends writes. Returns the seconds until there may be more to do.
  double advance();
  /// Waits for a write in progress, and writes the present points. Throws what that throws.
  void writeNow();

 private:
  struct Result {
    std::uint64_t points = 0;
    std::string words;
    bool failed = false;
  };
  bool collect();
  void begin();
  void end();
  static Result write(const Parts& parts, const std::vector<PointState>& changed);

  Parts parts_;
  bool isWanted_ = false;
  std::uint64_t begun_ = 0, ended_ = 0;  // writes
  Result last_;
  std::optional<Stopwatch> since_;  // the last one has begun
  // Of the next write: the points that differ from those as served, up to this place in the order.
  SharedPoints::Place place_;
  std::vector<PointState> changed_;
  std::future<Result> running_;  // destroyed first
};

}  // namespace palpate::sharing
