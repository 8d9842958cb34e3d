#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "engine/motion/fused_stream.hpp"

namespace palpate {

/// The map into which the frames of a depth stream are fused on the host: points in metres, relative to the map's
/// origin. A point moves from its shown position and normal to those of the map until the next frame is due
/// (CloudFrame::comes_s); a new point appears at once. If another source takes over the stream, the map is unchanged.
class FusedSource final : public CloudSource {
 public:
  /// Throws like FusionOptions::validate() and SurfelMap::begin().
  explicit FusedSource(FusedStream frames);

  std::size_t size() const override { return fusion_.map().options().capacity; }
  bool keepsPoints() const override { return true; }
  bool turnsNormals() const override { return true; }
  /// Fuses all frames of the player that are due. If it returns every frame (PlayOptions::exact), the same time has the
  /// same map: if the time went back, the map restarts. A frame that cannot be placed or fused is reported, counts as
  /// lost, and leaves the map unchanged.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  const FrameFusion& fusion() const { return fusion_; }

 private:
  void begin();
  // From that time on the shown points move towards the map.
  void setOut(double from_s);
  void fuseDue(double time_s);

  FusedStream frames_;
  std::optional<CameraPose> begunFrom_;  // pose of the last frame in the cloud that the map begins with
  bool isExact_;
  FrameFusion fusion_;
  double time_s_ = 0;   // time of the frame fused last
  double lasts_s_ = 0;  // until the next frame is due
  // A point as shown last, and its motion to that state; no normal: it was not shown.
  struct Shown {
    Vec3 place{0}, normal{0};
    shared::SurfelWay way{Vec3(0), Vec3(0)};
  };
  std::vector<Shown> shown_;  // by id
  PointsTime shownTime_;
  std::uint64_t changes_ = 0, shownChanges_ = ~0ull;  // number of changes of the map; the same when last shown
};

}  // namespace palpate
