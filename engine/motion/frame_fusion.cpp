#include "engine/motion/frame_fusion.hpp"

#include "engine/motion/pixel_surface.hpp"

namespace palpate {

void FrameFusion::begin(const PointCloud& cloud, const std::optional<CameraPose>& seenFrom) {
  map_.begin(cloud);
  intake_.beginAt(seenFrom);
}

const FrameOutcome& FrameFusion::leftOut(FrameFate fate) {
  outcome_.fate = fate;
  outcome_.why = intake_.why();
  return outcome_;
}

const FrameOutcome& FrameFusion::fuse(const DepthCamera& camera, const DepthFrame& frame) {
  outcome_ = {};
  if (!intake_.read(camera, frame)) return leftOut(FrameFate::refused);
  findPixelSurfaces(intake_.images(), map_.options(), surfaces_);
  const std::optional<CameraPose> pose =
      intake_.place(frame, [&](const CameraPose& expected, const IcpOptions& options) {
        return findPose(map_, intake_.images(), surfaces_, expected, options);
      });
  outcome_.search = intake_.search();
  if (!pose) return leftOut(FrameFate::unplaced);
  outcome_.fate = FrameFate::fused;
  outcome_.pose = *pose;
  outcome_.counts = map_.fuse(intake_.images(), surfaces_, *pose);
  intake_.fused(*pose, outcome_.counts.refused);
  return outcome_;
}

}  // namespace palpate
