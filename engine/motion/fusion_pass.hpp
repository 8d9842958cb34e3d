#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/motion/fusion.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

class Queue;

/// Fuses depth frames of one camera into a live cloud on the GPU, as SurfelMap does on the host: reads the points of
/// one half, and writes the fused points to the input of the index build, in any order, with ids in w. A build then
/// writes them into the other half (SpatialHash::recordBuild). No 64-bit atomics and no order-dependent sums: the same
/// points in the same slots and the same frame give the same bytes.
class FusionPass {
 public:
  /// `slots`: of the live cloud, options.capacity or more. Throws Error like FusionOptions::validate() and
  /// requireCamera(), and OutOfGpuMemory.
  FusionPass(Device& device, const DepthCamera& camera, const FusionOptions& options, std::uint32_t slots);

  /// Before the first frame, and to restart: the first ids are those of an existing cloud, whose points count as
  /// stable, with their colours; the other ids are free. Blocks.
  void reset(Queue& queue, const PointCloud& given);
  /// Input of the next run of a recorded list: a frame of this camera from readFrame(), seen from `pose` in the world,
  /// and the map's origin. Not while such a list is running. Throws like requirePose().
  void put(const FrameImages& images, const CameraPose& pose, const DVec3& origin);
  /// Sets the pose of a frame that was put already.
  void setPose(const FrameImages& images, const CameraPose& pose, const DVec3& origin);
  /// Fuses the frame that was put. Reads all slots of `from` and writes all of `to`, which must be other memory. May be
  /// recorded ahead for both halves and submitted repeatedly.
  void record(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to) const {
    record(list, from, to, {});
  }
  /// The same for a map that is felt: the points move over time. Addresses of the velocities of both halves, with
  /// rotations (shaders/shared/motion.h).
  struct Velocities {
    DeviceAddress from = 0, to = 0;
  };
  void record(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
              const Velocities& velocities) const;
  /// Only for a map that is felt; applies to frames put from now on: points reach their new positions within `comes_s`,
  /// and those of the previous frame have `left_s` of their motion left.
  void setWay(double left_s, double comes_s);

  /// Surfaces of the frame's pixels, for a pose search before fusion; record() includes them.
  void recordSurfaces(CommandList& list) const;

  /// Changes of the points by the last run, once it is done.
  FusionCounts counts() const;
  /// By id: weight, age and colour (shared::SurfelRecord).
  const Buffer& records() const { return records_; }
  const DepthCamera& camera() const { return camera_; }
  /// The frame that was put, in GPU memory; the surfaces are valid after recordSurfaces().
  struct FrameAddresses {
    DeviceAddress view, depths, surfaces;
  };
  FrameAddresses frame() const {
    return {images_.view.address(), images_.depths.address(), images_.surfaces.address()};
  }
  /// GPU memory besides the cloud.
  std::uint64_t bytes() const;

 private:
  // Indexed by pixel.
  struct Images {
    Buffer view, depths, colors, surfaces, covered;
  };
  // Pixels that need a new point, as bits in words of 32; and for each of them id and slot.
  struct NewPoints {
    Buffer pixels, before, scratch, places;
  };
  // Indexed by words of 32.
  struct Free {
    Buffer ids, slots, idsBefore, slotsBefore, idScratch, slotScratch;
  };
  struct Passes {
    ComputePipeline pixelSurface, fusePoints, findNew, countFree, listFree, appendPoints;
  };

  void recordUpdate(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                    const Velocities& velocities) const;
  void recordAppend(CommandList& list, const LiveCloud::Half& to, DeviceAddress velocities) const;
  std::uint32_t pixels() const { return camera_.width * camera_.height; }
  std::uint32_t pixelWords() const;
  std::uint32_t slotWords() const;

  Device& device_;
  DepthCamera camera_;
  FusionOptions options_;
  std::uint32_t slots_;
  Passes passes_;
  PrefixScan scan_;
  bool isFelt_ = false;
  float left_s_ = 0, perSecond_ = 0;
  Images images_;
  NewPoints new_;
  Free free_;
  Buffer records_, totals_, totalsRead_;
};

}  // namespace palpate
