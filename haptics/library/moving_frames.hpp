// Frames of a session's points, where those move: provided by the program, or by what moves them here.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/motion/cloud_source.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// Frames of a cloud that the program provides, each for its time.
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

/// For one thread at a time, but push().
class MovingFrames {
 public:
  /// `options`: of points that the program moves frame by frame, which begin as `model`.
  MovingFrames(const std::optional<pp_frames_options>& options, const Model& model);

  /// What the program provides; null: it provides nothing.
  CloudSource* pushed() const { return pushed_.get(); }
  /// Adds a frame, with positions in file coordinates; from any thread. Throws UsageError, and StateError if the
  /// program provides no frames.
  void push(PointCloud cloud, std::vector<Vec3> velocities, double time_s);

  /// The newest frame; in a live session one that is not older than the call, if one comes within 50 ms.
  std::shared_ptr<const FrameObject> newest(Session& session, bool isLive);
  /// Time restarts at 0, as it does after a live session.
  void restart();
  void beginLive() { isLive_ = true; }
  void endLive(Session& session);

 private:
  bool take(Session& session);

  std::unique_ptr<PushedFrames> pushed_;
  DVec3 origin_;  // of positions
  std::shared_ptr<const FrameObject> newest_;
  bool isLive_ = false;  // frames have times of a live session
};

}  // namespace palpate::library
