#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/motion/fusion.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

class Queue;

/// Fuses depth frames of one camera into a live cloud on the GPU, as SurfelMap does on the host: reads the points of
/// one half, and writes them with what the frame changes to where the index is built from, in any order, w carrying the
/// ids. A build then brings them into the other half (SpatialHash::recordBuild). No atomics on 64 bits, and no sum
/// whose order matters: the same points in the same slots and the same frame give the same bytes.
class FusionPass {
 public:
  /// `slots`: of the live cloud, options.capacity or more. Throws Error as FusionOptions::validate() and
  /// requireCamera(), and OutOfGpuMemory.
  FusionPass(Device& device, const DepthCamera& camera, const FusionOptions& options, std::uint32_t slots);

  /// Before the first frame, and to begin anew: the first ids are those of a cloud that is there, whose points count as
  /// measured often enough, with their colours; the others are free. Waits.
  void reset(Queue& queue, const PointCloud& given);
  /// What the next run of a recorded list fuses: a frame of this camera, as readFrame() gives it, seen from `pose` in
  /// the world, into a map of that origin. Not while such a list is running. Throws as requirePose().
  void put(const FrameImages& images, const CameraPose& pose, const DVec3& origin);
  /// The same for a frame that was put already, whose pose is found only now.
  void setPose(const FrameImages& images, const CameraPose& pose, const DVec3& origin);
  /// Fuses what was put. Reads all slots of `from` and writes all of `to`, which must be other memory. May be recorded
  /// ahead for both halves and submitted again and again.
  void record(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to) const {
    record(list, from, to, {});
  }
  /// The same for a map that is felt: what the frame does to a point it does over a time. The addresses are of the
  /// velocities of both halves, with turns (shaders/shared/motion.h).
  struct Velocities {
    DeviceAddress from = 0, to = 0;
  };
  void record(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
              const Velocities& velocities) const;
  /// Of the frames that are put from now on: points come to where it puts them within `comes_s`, and those of the one
  /// before still have a way of `left_s` before them. A map that is felt, alone.
  void setWay(double left_s, double comes_s);

  /// What the frame's pixels see, for who looks for its pose first; record() has it with the rest.
  void recordSurfaces(CommandList& list) const;

  /// What became of the points in the last run, once it is done.
  FusionCounts counts() const;
  /// By id: weight, age and colour (shared::SurfelRecord).
  const Buffer& records() const { return records_; }
  const DepthCamera& camera() const { return camera_; }
  /// The frame that was put, in memory of the GPU; the surfaces from recordSurfaces() on.
  struct FrameAddresses {
    DeviceAddress view, depths, surfaces;
  };
  FrameAddresses frame() const {
    return {images_.view.address(), images_.depths.address(), images_.surfaces.address()};
  }
  /// On the GPU, besides the cloud.
  std::uint64_t bytes() const;

 private:
  // By pixel.
  struct Images {
    Buffer view, depths, colors, surfaces, covered;
  };
  // Pixels that need a new point, by bits and by words of 32; and by such a pixel, id and slot.
  struct NewPoints {
    Buffer pixels, before, scratch, places;
  };
  // By words of 32.
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
