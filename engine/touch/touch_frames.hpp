#pragma once

#include <memory>
#include <optional>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/touch/frame_pipeline.hpp"
#include "engine/touch/touch_options.hpp"

namespace palpate {

struct PointCloud;

/// Whether something moves the points.
inline bool moves(const TouchOptions& options) { return options.source || options.fusion; }
/// Whether normals turn from frame to frame.
inline bool normalsTurn(const TouchOptions& options) {
  return options.fusion || (options.source && options.source->turnsNormals());
}
/// Empty slots of the live cloud behind the points that are there.
std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options);

/// The frames of the touch side, where something moves its points: who writes them, and how they come into the live
/// cloud. Without any, nothing happens here. For the thread that asks.
class TouchFrames {
 public:
  /// `index` must outlive it. `origin`: of the live cloud. Brings the frame of time 0.
  TouchFrames(Device& device, const TouchOptions& options, LiveIndex& index, const DVec3& origin);

  bool move() const { return frames_.has_value(); }
  /// For whoever draws on the same GPU; null where nothing moves.
  FramePipeline* pipeline() { return frames_ ? &*frames_ : nullptr; }
  /// Of the half, as shaders/shared/motion.h has them; 0 where nothing moves.
  DeviceAddress velocities(std::uint32_t parity) const { return frames_ ? frames_->velocities(parity).address() : 0; }
  /// Of the frame that is felt.
  PointsTime pointsTime() const { return frames_ ? frames_->pointsTime(index_.parity()) : PointsTime{}; }
  /// How the points have gone on from their frame until `now_s`, for a probe that was asked last at `last_s`.
  PointsMotion motionSince(double last_s, double now_s) const;

  /// FramePipeline's.
  void bring(double time_s) { frames_->bring(time_s); }
  bool goOn(double time_s, bool isRead) { return frames_ && frames_->goOn(time_s, isRead); }
  void finish() {
    if (frames_) frames_->finish();
  }
  bool take(CloudFrame& frame) { return frames_ && frames_->take(frame); }
  /// TouchBackend's, where something moves.
  std::size_t readBack(PointCloud& cloud) const;
  /// No thread of it submits anything from now on, nor makes a frame.
  void stop() {
    if (frames_) frames_->stop();
  }

 private:
  LiveIndex& index_;
  std::unique_ptr<FrameWriter> writer_;
  std::optional<FramePipeline> frames_;
};

}  // namespace palpate
