#pragma once

#include <string>

#include "engine/core/log.hpp"
#include "engine/motion/fusion.hpp"
#include "engine/motion/pose_tracker.hpp"

namespace palpate {

/// What becomes of depth frames on their way into a map, for whoever fuses, on the host or on the GPU: each is read and
/// placed, or else left out, counted and said.
class FrameIntake {
 public:
  /// `log`, if any, must outlive it.
  FrameIntake(const FusionOptions& options, const IcpOptions& icp, Log* log)
      : options_(options), log_(log), tracker_(icp) {}

  /// False where a frame is none: of another size, with depths that are no numbers, or with a pose that is none.
  bool read(const DepthCamera& camera, const DepthFrame& frame);
  /// Of the last one that was read.
  const FrameImages& images() const { return images_; }
  /// Where a frame that was read was seen from; nothing where `search` does not find it.
  std::optional<CameraPose> place(const DepthFrame& frame, const PoseTracker::Search& search);
  /// It was fused from there; `refused`: how many new points found no room.
  void fused(const CameraPose& pose, std::uint64_t refused);
  /// Says, once, that the map is full, where points have found no room.
  void sayWhereFull(std::uint64_t refused);
  /// For a frame that its stream could not give.
  void countLost(std::string_view why, std::uint64_t frames = 1);
  /// Anew, from where the last frame was seen; nothing: from the beginning.
  void beginAt(const std::optional<CameraPose>& seenFrom);

  /// Of the last frame: why it was left out, and the search for its pose.
  const std::string& why() const { return why_; }
  const IcpResult& search() const { return tracker_.result(); }
  std::uint64_t fused() const { return fused_; }
  std::uint64_t unplaced() const { return unplaced_; }
  /// Frames that were refused, or could not be read.
  std::uint64_t lost() const { return lost_; }

 private:
  void noteNumber(std::uint64_t number);
  void leaveOut(std::uint64_t number, std::string why);

  FusionOptions options_;
  Log* log_;
  PoseTracker tracker_;
  FrameImages images_;
  std::optional<std::uint64_t> number_;  // of the last frame
  std::uint64_t fused_ = 0, unplaced_ = 0, lost_ = 0;
  bool saidFull_ = false;
  std::string why_;
};

}  // namespace palpate
