// Frames of a cloud that the program provides, each for its time.
#pragma once

#include <deque>
#include <mutex>

#include "engine/cloud/point_cloud.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate::library {

/// Provides the newest frame whose time has come, and discards those before it. Thread-safe.
class PushedFrames final : public CloudSource {
 public:
  static constexpr std::size_t kMaxPending = 1023;

  /// Begins with the points of `first`, at rest. `most`: maximum number of points of a frame. `keeps`: each point has
  /// the same index in all frames.
  PushedFrames(const PointCloud& first, std::size_t most, bool keeps);

  std::size_t size() const override { return most_; }
  bool keepsPoints() const override { return keeps_; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  /// Adds a frame; the oldest of more than kMaxPending pending ones is dropped. Throws UsageError if requireWhole()
  /// refuses it, or if its time is not after that of the frame before.
  void push(CloudFrame frame);
  /// Restarts time at 0, with the newest frame.
  void restart();

 private:
  // Index of the newest frame whose time has come; 0 if there is none.
  std::size_t at(double time_s) const;

  std::size_t most_;
  bool keeps_;
  mutable std::mutex lock_;  // guards frames_
  std::deque<CloudFrame> frames_;
};

}  // namespace palpate::library
