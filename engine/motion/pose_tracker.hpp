#pragma once

#include <functional>
#include <optional>

#include "engine/motion/icp.hpp"

namespace palpate {

/// Tracks a camera from frame to frame: a frame has its own pose, or one found in the map near the previous one. For
/// fusion on the host or on the GPU.
class PoseTracker {
 public:
  explicit PoseTracker(const IcpOptions& options = {}) : options_(options) {}

  /// Searches for a pose near an expected one, with these options.
  using Search = std::function<IcpResult(const CameraPose& expected, const IcpOptions& options)>;
  /// The pose of `frame`, by `search` if it has none; nothing if that fails, and result() says why. The first frame
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

}  // namespace palpate
