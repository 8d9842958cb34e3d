#pragma once

#include <functional>
#include <optional>
#include <string>

#include "engine/core/log.hpp"
#include "engine/motion/fusion.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// Tracks a camera from frame to frame: a frame has its own pose, or one found in the map near the previous one. For
/// fusion on the host or on the GPU.
class PoseTracker {
 public:
  explicit PoseTracker(const IcpOptions& options = {}) : options_(options) {}

  /// Searches for a pose near an expected one, with these options.
  using Search = std::function<IcpResult(const CameraPose& expected, const IcpOptions& options)>;
  /// The pose of `frame`, by `search` if it is unknown; nothing if that fails, and result() says why. The first frame
  /// without a pose is at the world's origin.
  std::optional<CameraPose> place(const DepthFrame& frame, const Search& search);
  /// Result of the last search; state `found` if none was needed.
  const IcpResult& result() const { return result_; }

  /// The frame was fused from that pose; or it was not, and the camera has more time to move.
  void fused(const CameraPose& pose);
  void missed(std::uint64_t frames = 1) { missed_ += frames; }
  /// Restarts at the pose of the last frame; nothing: from the beginning.
  void beginAt(const std::optional<CameraPose>& seenFrom);

 private:
  IcpOptions options_;
  std::optional<CameraPose> last_;  // of the last frame fused
  std::uint64_t missed_ = 0;        // frames since then
  IcpResult result_;
};

/// Reads frames and finds their poses for fusion, on the host or on the GPU. A frame that fails is left out, counted
/// and reported.
class FrameIntake {
 public:
  /// `log`, if any, must outlive it.
  FrameIntake(const FusionOptions& options, const IcpOptions& icp, Log* log)
      : options_(options), log_(log), tracker_(icp) {}

  /// False for an invalid frame: wrong size, depths that are not finite, or an invalid pose.
  bool read(const DepthCamera& camera, const DepthFrame& frame);
  /// Images of the last frame read.
  const FrameImages& images() const { return images_; }
  /// Pose of a frame that was read; nothing if `search` does not find it.
  std::optional<CameraPose> place(const DepthFrame& frame, const PoseTracker::Search& search);
  /// The frame was fused from that pose; `refused`: number of new points that exceeded the capacity.
  void fused(const CameraPose& pose, std::uint64_t refused);
  /// Logs once that the map is full if `refused` > 0.
  void sayWhereFull(std::uint64_t refused);
  /// For a frame that the stream could not read.
  void countLost(std::string_view why, std::uint64_t frames = 1);
  /// Restarts at the pose of the last frame; nothing: from the beginning.
  void beginAt(const std::optional<CameraPose>& seenFrom);

  /// Why the last frame was left out, and the search for its pose.
  const std::string& why() const { return why_; }
  const IcpResult& search() const { return tracker_.result(); }
  std::uint64_t fused() const { return fused_; }
  std::uint64_t unplaced() const { return unplaced_; }
  /// Frames that were invalid or could not be read.
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
