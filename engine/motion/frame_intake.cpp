#include "engine/motion/frame_intake.hpp"

#include <utility>

#include "engine/core/error.hpp"

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

// Missing numbers are frames lost or dropped: the camera had more time to move.
void FrameIntake::noteNumber(std::uint64_t number) {
  if (number_ && number > *number_ + 1) tracker_.missed(number - *number_ - 1);
  number_ = number;
}

bool FrameIntake::read(const DepthCamera& camera, const DepthFrame& frame) {
  noteNumber(frame.number);
  try {
    readFrame(camera, frame, options_, images_);
    if (frame.pose) requirePose(*frame.pose, frame.number);
    return true;
  } catch (const Error& error) {
    ++lost_;
    leaveOut(frame.number, error.what());
    return false;
  }
}

std::optional<CameraPose> FrameIntake::place(const DepthFrame& frame, const PoseTracker::Search& search) {
  std::optional<CameraPose> pose = tracker_.place(frame, search);
  if (pose) return pose;
  ++unplaced_;
  leaveOut(frame.number, tracker_.result().why());
  return std::nullopt;
}

void FrameIntake::fused(const CameraPose& pose, std::uint64_t refused) {
  tracker_.fused(pose);
  ++fused_;
  sayWhereFull(refused);
}

void FrameIntake::sayWhereFull(std::uint64_t refused) {
  if (refused > 0 && !std::exchange(saidFull_, true) && log_)
    log_->warn("the map is full: {} points; new points are not added", options_.capacity);
}

void FrameIntake::countLost(std::string_view why, std::uint64_t frames) {
  if (frames == 0) return;
  lost_ += frames;
  if (log_) log_->warn("a frame is lost: {}", why);
}

void FrameIntake::leaveOut(std::uint64_t number, std::string why) {
  tracker_.missed();
  why_ = std::move(why);
  if (log_) log_->warn("frame {} is not fused: {}", number, why_);
}

void FrameIntake::beginAt(const std::optional<CameraPose>& seenFrom) {
  tracker_.beginAt(seenFrom);
  number_.reset();
  fused_ = unplaced_ = lost_ = 0;
}

}  // namespace palpate
