#pragma once

#include <array>

#include "engine/core/background_task.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/frame_exchange.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// The frames of a source with their index, for touch on the CPU: one half is felt while the next frame is made in the
/// other half.
class CpuFrames final : public FrameStream {
 public:
  /// Starts with the frame of time 0. `source` must outlive it.
  CpuFrames(CloudSource& source, const HashGrid& grid, unsigned threads);

  /// Virtual time: the frame of that time is felt from now on.
  void bring(double time_s);
  /// Against the clock, between ticks: flips to a completed frame and starts the next one, for that time. Allocates
  /// nothing; throws the error that making a frame has thrown.
  void goOn(double time_s);
  /// Completes the frame in progress, which is felt from now on.
  void finish();
  bool take(CloudFrame& frame) override;
  std::optional<PointsTime> time() const noexcept override { return frame().time(); }

  const SortedGrid& grid() const { return halves_[front_].grid; }
  const CloudFrame& frame() const { return halves_[front_].frame; }
  /// Number of frames felt so far.
  std::uint64_t count() const { return count_; }

 private:
  struct Half {
    CloudFrame frame;
    SortedGrid grid;
  };
  std::uint32_t back() const { return 1 - front_; }
  void make();
  // Flips to the frame made last, if it is new.
  void flip();

  CloudSource& source_;
  std::array<Half, 2> halves_;
  std::uint32_t front_ = 0;
  FrameExchange exchange_;
  std::uint64_t count_ = 0;
  double wanted_s_ = 0;  // time of the frame in progress
  bool isMaking_ = false;
  bool isNew_ = false;   // the frame made last is new
  BackgroundTask task_;  // destroyed first
};

}  // namespace palpate
