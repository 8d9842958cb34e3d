// Depth frames that are felt while they are fused, for each back end: a sphere on a table, which is taken away.
#pragma once

#include <doctest/doctest.h>

#include <functional>

#include "engine/cloud/spacing.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/touch/touch_backend.hpp"
#include "shaders/shared/contact.h"
#include "tests/motion/depth_scene.hpp"
#include "tests/near.hpp"

namespace palpate {

/// Frames at 30 Hz without noise, without the sphere from frame kTaken on.
class TableStream final : public DepthStream {
 public:
  static constexpr std::uint64_t kFrames = 18, kTaken = 8;
  static constexpr double kPeriod_s = 1.0 / 30;

  /// `posed`: every frame has a camera pose. Otherwise only the first one has, and objects that determine the pose stay
  /// on the table.
  explicit TableStream(bool posed = true) : camera_(smallCamera()) {
    const DepthScene things = tableScene();
    DepthScene empty, whole;
    empty.add("plane", 0.8, DVec3(0));
    whole.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, {0, 0, 0.04});
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      const CameraPose pose = onArc(DVec3(0, 0, 0.02), 0.8, 0.03 * static_cast<double>(i));
      const DepthScene& seen = !posed ? things : i < kTaken ? whole : empty;
      frames_.push_back(seen.frame(camera_, pose, 0, i));
      if (!posed && i > 0) frames_.back().pose.reset();
      frames_.back().time_s = kPeriod_s * static_cast<double>(i);
      frames_.back().colors.assign(frames_.back().depth_m.size(), {10, 200, 30});
    }
  }

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    if (at_ == frames_.size()) return false;
    frame = frames_[at_++];
    return true;
  }
  bool isRecorded() const override { return true; }
  void rewind() override { at_ = 0; }
  const DepthFrame& at(std::size_t frame) const { return frames_[frame]; }
  std::uint64_t frames() const override { return frames_.size(); }
  double duration_s() const override { return frames_.back().time_s; }
  /// The first frame as the map before any query, and the stream of the following frames.
  FusedStream fused(const FusionOptions& options, const PlayOptions& play = {}) {
    FrameFusion fusion(smallMap());
    const FrameOutcome& outcome = fusion.fuse(camera_, frames_.front());
    FusedStream frames{.stream = playedStream(unowned(*this), play),
                       .begin = std::make_shared<PointCloud>(fusion.map().cloud()),
                       .options = options};
    frames.stream->player->beginBehind({.pass = 0, .time_s = 0});
    frames.stream->seenFrom = outcome.pose;
    return frames;
  }

 private:
  DepthCamera camera_;
  std::vector<DepthFrame> frames_;
  std::size_t at_ = 0;
};

struct FusedTouch {
  std::unique_ptr<TouchBackend> backend;
  std::unique_ptr<CloudSource> source;  // used by the back end
};
/// Makes a back end that feels the map into which the stream's frames are fused.
using MakeFusedTouch = std::function<FusedTouch(TableStream& stream, double radius)>;

/// The table is felt at its position, and so is the sphere; once free space has contradicted the sphere nothing of it
/// remains.
inline void checkFusedTouch(const MakeFusedTouch& make, double tick_s = 1e-3) {
  constexpr double kDepth = 0.001;
  for (const bool onSphere : {false, true}) {
    CAPTURE(onSphere);
    TableStream stream;
    const PointCloud cloud = *stream.fused(smallMap()).begin;
    const double spacing = meanSpacing(cloud);
    CHECK(spacing < 0.003);
    FusedTouch touch = make(stream, 4 * spacing);
    const DVec3 on = onSphere ? DVec3(0, 0, 0.08) : DVec3(0.09, -0.03, 0);
    const double duration_s = TableStream::kPeriod_s * TableStream::kFrames;
    int touched = 0, free = 0;
    Contact contact;
    for (int i = 0; tick_s * i < duration_s; ++i) {
      const double time_s = tick_s * i, height = std::max(0.01 - 0.0005 * i, -kDepth);
      contact = touch.backend->query({.time_s = time_s, .hip = on + DVec3(0, 0, height)}, 0);
      CHECK(contact.valid);
      if (height > -kDepth) continue;
      (contact.touching ? touched : free) += 1;
      // The averaged surface is 0.07 R^2 / rho inside the sphere.
      if (contact.touching && time_s < TableStream::kPeriod_s * TableStream::kTaken)
        CHECK(std::abs(contact.proxy.z - on.z) < (onSphere ? 0.0008 : 0.0002));
    }
    CHECK(touched > 0.2 / tick_s);
    CHECK(contact.touching == !onSphere);
    if (!onSphere) CHECK(free == 0);
    touch.backend->finish();
    CloudFrame seen;
    CHECK(touch.backend->frames()->take(seen));
    CHECK(seen.time_s == near(TableStream::kPeriod_s * (TableStream::kFrames - 1), 1e-6));
    std::size_t left = 0;
    for (const Vec3& place : seen.positions) left += place.z > 0.01f;
    CHECK(left < shared::kMinNeighbours);  // too few for a surface: points at the rim that no ray has passed
    CHECK(seen.size() > 5'000);
    CHECK(seen.colors.front() == std::array<std::uint8_t, 3>{10, 200, 30});
    PointCloud end = cloud;
    touch.backend->readBack(end);
    CHECK(end.positions == seen.positions);
    CHECK(end.colors.size() == end.size());
  }
}

}  // namespace palpate
