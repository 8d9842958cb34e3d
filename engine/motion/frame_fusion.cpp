#include "engine/motion/frame_fusion.hpp"

#include <utility>

#include "engine/core/error.hpp"
#include "engine/motion/pixel_surface.hpp"

namespace palpate {

FrameFusion::FrameFusion(const FusionOptions& options, const IcpOptions& icp, Log* log)
    : icp_(icp), log_(log), map_(options) {}

void FrameFusion::clear() {
  map_.clear();
  last_.reset();
  sinceLast_ = fused_ = unplaced_ = lost_ = 0;
  saidFull_ = false;
}

const FrameOutcome& FrameFusion::fuse(const DepthCamera& camera, const DepthFrame& frame) {
  outcome_ = {};
  try {
    readFrame(camera, frame, map_.options(), images_);
    if (frame.pose) requirePose(*frame.pose, frame.number);
  } catch (const Error& error) {
    leaveOut(FrameFate::refused, frame.number, error.what());
    return outcome_;
  }
  findPixelSurfaces(images_, map_.options(), surfaces_);
  const std::optional<CameraPose> pose = place(frame);
  if (!pose) return outcome_;
  outcome_.fate = FrameFate::fused;
  outcome_.pose = *pose;
  outcome_.counts = map_.fuse(images_, surfaces_, *pose);
  last_ = pose;
  sinceLast_ = 0;
  ++fused_;
  if (outcome_.counts.refused > 0 && !std::exchange(saidFull_, true) && log_)
    log_->say("the map is full: {} points; what is seen anew finds no room", map_.options().capacity);
  return outcome_;
}

std::optional<CameraPose> FrameFusion::place(const DepthFrame& frame) {
  if (frame.pose) return frame.pose;
  if (!last_ || map_.count() == 0) return last_.value_or(CameraPose{});
  IcpOptions options = icp_;
  // The camera has had so much more time to move.
  options.longestStep_m *= static_cast<double>(1 + sinceLast_);
  options.largestTurn_deg *= static_cast<double>(1 + sinceLast_);
  outcome_.search = findPose(map_, images_, surfaces_, *last_, options);
  if (outcome_.search.state == IcpState::found) return outcome_.search.pose;
  leaveOut(FrameFate::unplaced, frame.number, outcome_.search.why());
  return std::nullopt;
}

void FrameFusion::countLost(std::string_view why) {
  ++lost_;
  ++sinceLast_;
  if (log_) log_->say("a frame is lost: {}", why);
}

void FrameFusion::leaveOut(FrameFate fate, std::uint64_t number, std::string why) {
  ++(fate == FrameFate::refused ? lost_ : unplaced_);
  ++sinceLast_;
  outcome_.fate = fate;
  outcome_.why = std::move(why);
  if (log_) log_->say("frame {} is not fused: {}", number, outcome_.why);
}

}  // namespace palpate
