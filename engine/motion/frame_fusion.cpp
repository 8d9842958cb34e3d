#include "engine/motion/frame_fusion.hpp"

#include <utility>

#include "engine/core/error.hpp"
#include "engine/motion/pixel_surface.hpp"

namespace palpate {

FrameFusion::FrameFusion(const FusionOptions& options, const IcpOptions& icp, Log* log)
    : log_(log), map_(options), tracker_(icp) {}

void FrameFusion::clear() {
  map_.clear();
  tracker_.clear();
  fused_ = unplaced_ = lost_ = 0;
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
  const std::optional<CameraPose> pose =
      tracker_.place(frame, [&](const CameraPose& expected, const IcpOptions& options) {
        return findPose(map_, images_, surfaces_, expected, options);
      });
  outcome_.search = tracker_.result();
  if (!pose) {
    leaveOut(FrameFate::unplaced, frame.number, outcome_.search.why());
    return outcome_;
  }
  outcome_.fate = FrameFate::fused;
  outcome_.pose = *pose;
  outcome_.counts = map_.fuse(images_, surfaces_, *pose);
  tracker_.fused(*pose);
  ++fused_;
  if (outcome_.counts.refused > 0 && !std::exchange(saidFull_, true) && log_)
    log_->say("the map is full: {} points; what is seen anew finds no room", map_.options().capacity);
  return outcome_;
}

void FrameFusion::countLost(std::string_view why) {
  ++lost_;
  tracker_.missed();
  if (log_) log_->say("a frame is lost: {}", why);
}

void FrameFusion::leaveOut(FrameFate fate, std::uint64_t number, std::string why) {
  ++(fate == FrameFate::refused ? lost_ : unplaced_);
  tracker_.missed();
  outcome_.fate = fate;
  outcome_.why = std::move(why);
  if (log_) log_->say("frame {} is not fused: {}", number, outcome_.why);
}

}  // namespace palpate
