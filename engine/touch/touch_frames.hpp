#pragma once

#include <memory>
#include <optional>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/touch/frame_pipeline.hpp"
#include "engine/touch/touch_backend.hpp"
#include "engine/touch/touch_options.hpp"

namespace palpate {

struct PointCloud;

/// Whether something moves the points.
inline bool moves(const TouchOptions& options) { return options.source || options.fusion; }
/// Whether normals rotate from frame to frame.
inline bool normalsTurn(const TouchOptions& options) {
  return options.fusion || (options.source && options.source->turnsNormals());
}
/// Number of empty slots of the live cloud after the present points.
std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options);

/// The frames of the touch side if its points move: the writer of the frames, and their transfer into the live cloud.
/// Does nothing if no points move. For the thread that asks.
class TouchFrames final : public FrameStream {
 public:
  /// `index` must outlive it. `origin`: of the live cloud. Builds the frame of time 0.
  TouchFrames(Device& device, const TouchOptions& options, LiveIndex& index, const DVec3& origin);

  bool move() const { return frames_.has_value(); }
  /// For drawing on the same GPU; null if nothing moves.
  FramePipeline* pipeline() { return frames_ ? &*frames_ : nullptr; }
  /// Velocities of the half, in the layout of shaders/shared/motion.h; 0 if nothing moves.
  DeviceAddress velocities(std::uint32_t parity) const { return frames_ ? frames_->velocities(parity).address() : 0; }
  std::optional<PointsTime> time() const noexcept override { return pointsTime(); }
  /// Time of the frame that is felt.
  PointsTime pointsTime() const noexcept { return frames_ ? frames_->pointsTime(index_.parity()) : PointsTime{}; }
  /// Motion of the points from their frame until `now_s`, for a probe that was last asked at `last_s`.
  PointsMotion motionSince(double last_s, double now_s) const;

  /// As in FramePipeline.
  void bring(double time_s) { frames_->bring(time_s); }
  bool goOn(double time_s, bool isRead) { return frames_ && frames_->goOn(time_s, isRead); }
  void finish() {
    if (frames_) frames_->finish();
  }
  bool take(CloudFrame& frame) override { return frames_ && frames_->take(frame); }
  /// As TouchBackend::readBack(), if points move.
  std::size_t readBack(PointCloud& cloud) const;
  /// Stops its threads: no further submission, no further frame.
  void stop() {
    if (frames_) frames_->stop();
  }

 private:
  LiveIndex& index_;
  std::unique_ptr<FrameWriter> writer_;
  std::optional<FramePipeline> frames_;
};

}  // namespace palpate
