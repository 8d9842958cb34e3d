#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/motion/fusion.hpp"

namespace palpate {

/// A map of surfels on the host: depth frames fused into one cloud (see shaders/shared/fusion.h). A point keeps its id;
/// ids of removed points are reused for new ones, the lowest first. The same frames give the same bytes, with any
/// number of threads.
class SurfelMap {
 public:
  /// Throws like FusionOptions::validate(). Memory grows with the number of points.
  explicit SurfelMap(const FusionOptions& options);

  /// Fuses a frame seen from `pose` in the world; `surfaces`: of its pixels. Throws Error for an invalid pose, and then
  /// changes nothing.
  FusionCounts fuse(const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                    const CameraPose& pose);

  /// World = origin + position. That of the initial cloud, or near the first frame's camera; constant.
  const DVec3& origin() const { return origin_; }
  /// Highest id used so far, plus one.
  std::size_t ids() const { return surfels_.size(); }
  bool holds(std::size_t id) const { return surfels_[id].record.weight > 0; }
  const shared::Surfel& surfel(std::size_t id) const { return surfels_[id]; }
  /// Number of points.
  std::size_t count() const { return surfels_.size() - free_.size(); }
  /// Whether a frame or the initial cloud had colours.
  bool isColored() const { return colored_; }
  /// Sums over all frames; `points` is the current number.
  const FusionCounts& totals() const { return totals_; }
  const FusionOptions& options() const { return options_; }

  /// The points in the order of their ids, in metres.
  PointCloud cloud() const;
  /// The same as a frame, with ids; its time is not changed.
  void show(CloudFrame& frame) const;
  /// Restarts with the points of a cloud, which have the first ids and count as stable, and with its origin; an empty
  /// cloud sets no origin. Throws Error if the points exceed the capacity.
  void begin(const PointCloud& cloud);

 private:
  struct Frame;
  void updatePoints(Frame& frame);
  void updatePoint(std::size_t id, Frame& frame);
  void appendPoints(Frame& frame);

  FusionOptions options_;
  DVec3 origin_{0};
  std::vector<shared::Surfel> surfels_;  // by id; weight 0: no point
  std::vector<std::uint32_t> free_;      // unused ids below ids(), the lowest last
  std::vector<std::uint32_t> covered_;   // by pixel: its parts that contain points
  bool colored_ = false;
  FusionCounts totals_;
  bool hasOrigin_ = false;
};

}  // namespace palpate
