#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/motion/fusion.hpp"

namespace palpate {

/// A map of surfels on the host: what depth frames have seen, fused into one cloud (shaders/shared/fusion.h says how).
/// Each point has an id for life; those that are removed give theirs to new ones, the lowest first. The same frames
/// give the same bytes, with any number of threads.
class SurfelMap {
 public:
  /// Throws as FusionOptions::validate(). Memory follows the points that there are.
  explicit SurfelMap(const FusionOptions& options);

  /// Fuses a frame that was seen from `pose`, in the world; `surfaces`: of its pixels. Throws Error for a pose that is
  /// none, and then nothing has changed.
  FusionCounts fuse(const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                    const CameraPose& pose);

  /// World = origin + place. Of the cloud that it began with, or follows the first frame's camera; stays.
  const DVec3& origin() const { return origin_; }
  /// One more than the highest id that a point has had.
  std::size_t ids() const { return surfels_.size(); }
  bool holds(std::size_t id) const { return surfels_[id].record.weight > 0; }
  const shared::Surfel& surfel(std::size_t id) const { return surfels_[id]; }
  /// Of points that are there.
  std::size_t count() const { return surfels_.size() - free_.size(); }
  /// Whether a frame has had colours, or the cloud that it began with.
  bool isColored() const { return colored_; }
  /// All frames together; points as they are now.
  const FusionCounts& totals() const { return totals_; }
  const FusionOptions& options() const { return options_; }

  /// The points in the order of their ids, in metres.
  PointCloud cloud() const;
  /// The same as a frame, with their ids; its time stays.
  void show(CloudFrame& frame) const;
  /// Begins anew with the points of a cloud, which have the first ids and count as measured often enough, and with its
  /// origin; without points there is no origin either. Throws Error where they are more than the capacity.
  void begin(const PointCloud& cloud);

 private:
  struct Frame;
  void updatePoints(Frame& frame);
  void updatePoint(std::size_t id, Frame& frame);
  void appendPoints(Frame& frame);

  FusionOptions options_;
  DVec3 origin_{0};
  std::vector<shared::Surfel> surfels_;  // by id; of weight 0 where there is none
  std::vector<std::uint32_t> free_;      // ids below ids() that no point has, the lowest last
  std::vector<std::uint32_t> covered_;   // by pixel: the parts in which points stand
  bool colored_ = false;
  FusionCounts totals_;
  bool hasOrigin_ = false;
};

}  // namespace palpate
