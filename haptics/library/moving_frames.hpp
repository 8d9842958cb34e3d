// Frames of a session's points, where those move: provided by the program, or by what moves them here.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "haptics/library/objects.hpp"
#include "haptics/library/pushed_frames.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

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
