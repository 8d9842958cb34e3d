#include "engine/motion/pose_tracker.hpp"

namespace palpate {

std::optional<CameraPose> PoseTracker::place(const DepthFrame& frame, const Search& search) {
  result_ = {.state = IcpState::found};
  if (frame.pose) return frame.pose;
  if (!last_) return CameraPose{};
  IcpOptions options = options_;
  options.longestStep_m *= static_cast<double>(1 + missed_);
  options.largestTurn_deg *= static_cast<double>(1 + missed_);
  result_ = search(*last_, options);
  if (result_.state != IcpState::found) return std::nullopt;
  return result_.pose;
}

void PoseTracker::fused(const CameraPose& pose) {
  last_ = pose;
  missed_ = 0;
}

void PoseTracker::beginAt(const std::optional<CameraPose>& seenFrom) {
  last_ = seenFrom;
  missed_ = 0;
  result_ = {};
}

}  // namespace palpate
