#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "engine/motion/fused_stream.hpp"

namespace palpate {

/// The map that the frames of a depth stream fuse into on the host, as it is at a time: points in metres, relative to
/// the map's origin. What a frame does to a point it does until the next one is due: from where it was shown, and with
/// the normal that it had, it comes to where it is now (CloudFrame::comes_s). A new one is there at once. A stream that
/// is taken from it leaves the map as it is.
class FusedSource final : public CloudSource {
 public:
  /// Throws as FusionOptions::validate() and SurfelMap::begin().
  explicit FusedSource(FusedStream frames);

  std::size_t size() const override { return fusion_.map().options().capacity; }
  bool keepsPoints() const override { return true; }
  bool turnsNormals() const override { return true; }
  /// All frames that are due by then and that the stream's player hands out are fused. Where those are all there are
  /// (PlayOptions::exact), the same time has the same map: where it has gone back, the map begins anew. A frame that
  /// cannot be placed or fused is said, counts as lost, and leaves the map as it was.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  const FrameFusion& fusion() const { return fusion_; }

 private:
  void begin();
  // From where it was shown, at that time, the map comes to what it is now.
  void setOut(double from_s);
  void fuseDue(double time_s);

  FusedStream frames_;
  std::optional<CameraPose> begunFrom_;  // from where the last frame of the map that it begins with was seen
  bool isExact_;
  FrameFusion fusion_;
  double time_s_ = 0;   // of the frame that was fused last
  double lasts_s_ = 0;  // until the next one is due
  // A point of the map as it was shown last, and the way on which it came there; without a normal it was not there.
  struct Shown {
    Vec3 place{0}, normal{0};
    shared::SurfelWay way{Vec3(0), Vec3(0)};
  };
  std::vector<Shown> shown_;  // by id
  PointsTime shownTime_;
  std::uint64_t changes_ = 0, shownChanges_ = ~0ull;  // of the map; and how many there were when it was shown
};

}  // namespace palpate
