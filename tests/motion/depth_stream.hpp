// A depth stream for tests: numbered frames, of which some cannot be read; recorded, or live as given by the test.
#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "engine/core/error.hpp"

namespace palpate {

inline constexpr DepthCamera kTinyCamera{.width = 4, .height = 3, .fx = 4, .fy = 4, .cx = 1.5, .cy = 1};

/// All depths increase by one metre per frame.
inline DepthFrame tinyFrame(std::uint64_t number, double time_s) {
  return {.time_s = time_s, .number = number, .depth_m = std::vector<float>(12, 1 + static_cast<float>(number))};
}

class RecordedStream final : public DepthStream {
 public:
  RecordedStream(std::vector<double> times_s, std::set<std::uint64_t> lost = {})
      : times_s_(std::move(times_s)), lost_(std::move(lost)) {}

  const DepthCamera& camera() const override { return kTinyCamera; }
  bool next(DepthFrame& frame) override {
    if (next_ == times_s_.size()) return false;
    const std::uint64_t number = next_++;
    if (lost_.contains(number)) throw Error("frame {} is torn", number);
    frame = tinyFrame(number, times_s_[number]);
    return true;
  }
  bool isRecorded() const override { return true; }
  void rewind() override { next_ = 0; }
  std::uint64_t skipTo(double time_s) override {
    const std::size_t before = next_;
    while (next_ + 1 < times_s_.size() && times_s_[next_ + 1] <= time_s) ++next_;
    return next_ - before;
  }
  std::uint64_t frames() const override { return times_s_.size(); }
  double duration_s() const override { return times_s_.back(); }

 private:
  std::vector<double> times_s_;
  std::set<std::uint64_t> lost_;
  std::size_t next_ = 0;
};

class LiveStream final : public DepthStream {
 public:
  explicit LiveStream(const DepthCamera& camera = kTinyCamera) : camera_(camera) {}
  const DepthCamera& camera() const override { return camera_; }
  /// May be called from any thread.
  void give(const DepthFrame& frame) {
    const std::scoped_lock lock(mutex_);
    given_.push_back(frame);
    changed_.notify_all();
  }
  void end() { stop(); }
  bool next(DepthFrame& frame) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stopped_ || next_ < given_.size(); });
    if (next_ == given_.size()) return false;
    frame = given_[next_++];
    return true;
  }
  void stop() noexcept override {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  bool isRecorded() const override { return false; }
  void rewind() override {}

 private:
  DepthCamera camera_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<DepthFrame> given_;
  std::size_t next_ = 0;
  bool stopped_ = false;
};

}  // namespace palpate
