#pragma once

#include <functional>
#include <optional>

#include "engine/motion/icp.hpp"

namespace palpate {

/// Follows a camera from frame to frame: a frame stands where it says, or else where it is found in the map, near the
/// one before. For whoever fuses, on the host or on the GPU.
class PoseTracker {
 public:
  explicit PoseTracker(const IcpOptions& options = {}) : options_(options) {}

  /// Looks for a pose about an expected one, with these options.
  using Search = std::function<IcpResult(const CameraPose& expected, const IcpOptions& options)>;
  /// Where `frame` was seen from, by `search` where it does not say so; nothing where that was not found, and result()
  /// says why. The first one of all that does not say so stands in the middle of the world.
  std::optional<CameraPose> place(const DepthFrame& frame, const Search& search);
  /// Of the last search; of state `found` where none was needed.
  const IcpResult& result() const { return result_; }

  /// The frame was fused from there; or it was not, and the camera has had so much longer to move.
  void fused(const CameraPose& pose);
  void missed(std::uint64_t frames = 1) { missed_ += frames; }
  /// From where the last frame was seen; nothing: from the beginning.
  void beginAt(const std::optional<CameraPose>& seenFrom);

 private:
  IcpOptions options_;
  std::optional<CameraPose> last_;  // from which a frame was fused
  std::uint64_t missed_ = 0;        // frames since then
  IcpResult result_;
};

}  // namespace palpate
