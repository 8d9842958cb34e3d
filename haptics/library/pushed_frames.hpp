// Frames of a cloud that a program brings, one by one, each for its time.
#pragma once

#include <deque>
#include <mutex>

#include "engine/cloud/point_cloud.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate::library {

/// At a time the newest frame whose time has come is felt; those before it are forgotten. push() is for any thread.
class PushedFrames final : public CloudSource {
 public:
  static constexpr std::size_t kMaxWaiting = 1024;

  /// Begins with the points of `first`, which stand still. `most`: points of a frame. `keeps`: each has its place in
  /// all frames.
  PushedFrames(const PointCloud& first, std::size_t most, bool keeps);

  std::size_t size() const override { return most_; }
  bool keepsPoints() const override { return keeps_; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  /// Throws UsageError for what requireWhole() refuses, and for a time that is not after that of the frame before;
  /// StateError where too many wait for their time.
  void push(CloudFrame frame);
  /// Time begins anew, with the newest frame.
  void restart();

 private:
  // Of the newest frame whose time has come; the first one where none has.
  std::size_t at(double time_s) const;

  std::size_t most_;
  bool keeps_;
  mutable std::mutex lock_;  // of
  std::deque<CloudFrame> frames_;
};

}  // namespace palpate::library
