#pragma once

#include <optional>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/splat_radii.hpp"

namespace palpate {

struct DrawnOptions {
  std::uint32_t spare = 0;  ///< points that edits may add
  bool painted = false;     ///< edits give colours, too
  /// Mean, model units (meanSpacing()): each point gets a disc that closes the surface around it. 0: none has one, and
  /// a frame must be given a radius.
  double spacing = 0;
  bool edited = false;  ///< keeps what it takes to measure the discs again where points have been edited, or have moved
};

/// The cloud that is seen, on the GPU: the sight side's own copy, in the order of the file, so that a point's id is its
/// place. It follows the touched cloud through the edit log alone, or through what a back end reports of its edits. All
/// of it, its making too, goes over the throughput queue.
class DrawnCloud {
 public:
  /// Normals and colours are optional. Throws OutOfGpuMemory.
  DrawnCloud(Device& device, const PointCloud& cloud, const DrawnOptions& options = {});

  /// Applies everything that is unread, in order, on the throughput queue, waits for it, and consumes it; says how many
  /// entries there were.
  std::uint64_t catchUp(EditLog::Reader& reader);
  /// The same with states from the host (TouchBackend::takeEdits()), front to back: for a cloud that is touched by
  /// another GPU, or by none. States of points without a place here are left out. The first call may throw
  /// OutOfGpuMemory.
  std::uint64_t catchUp(std::span<const PointState> states);
  /// Where all points move: takes over those of a live cloud on the same GPU, whole and in any order, or of a frame on
  /// the host, on the throughput queue, and waits. Points without a place here are left out, and those that are not
  /// among them are gone; a point that stands where its disc was measured, or next to it, keeps that. `colored`: the
  /// live normals carry colours, as FramePipeline puts them there.
  void place(const LiveCloud::Half& live, std::uint32_t slots, bool colored = false);
  void place(const CloudFrame& frame);
  /// Measures the discs again of the points that catchUp() or place() has changed, and of those around them. Before a
  /// frame.
  void closeSurface();

  /// Places in the arrays: the points of the file, and as many as may be added. Where no point is, or one is gone, the
  /// position is no number.
  std::uint32_t count() const { return count_; }
  bool hasColors() const { return hasColors_; }
  /// Of the cloud as it was loaded, whatever has moved since.
  const Bounds& bounds() const { return bounds_; }
  /// count vec4: xyz relative to the cloud's origin; w the bits of the id, or of kEmptySlot.
  const Buffer& positions() const { return points_.positions; }
  /// count vec4: xyz unit, or zero when unknown; w the radius of the disc, model units.
  const Buffer& normals() const { return points_.normals; }
  const Buffer& colors() const { return colors_; }  ///< count RGBA8; empty without colours
  const Buffer& clips() const { return clips_; }    ///< count words: where discs are cut off (SplatRadii)
  const Buffer& picked() const { return picked_; }  ///< count words, for whoever draws it
  /// Mean spacing as the options gave it, and the largest radius of a disc, model units; 0 where discs have none.
  double spacing() const { return spacing_; }
  double largestRadius() const { return largestRadius_; }
  std::uint64_t bytes() const;

 private:
  // A range of a ring of states on the GPU, from `firstSlot` on.
  struct Entries {
    DeviceAddress ring = 0;
    std::uint64_t slots = 1;  // a power of two
    std::uint64_t firstSlot = 0, count = 0;
  };
  void apply(const Entries& entries);

  Device& device_;
  std::uint32_t count_;
  bool hasColors_;
  Bounds bounds_;
  double spacing_, largestRadius_ = 0;
  LiveCloud::Half points_;
  Buffer colors_, clips_, picked_;
  Buffer latest_;                         // count uint32, zero between calls
  std::optional<Buffer> fromHost_;        // PointState; made when the host first has some
  std::optional<LiveCloud::Half> frame_;  // likewise
  ComputePipeline claim_, apply_, place_, leave_;
  CommandList list_;
  std::optional<SplatRadii> radii_;
  std::optional<Buffer> measured_;  // vec4: PlaceArgs
  bool isStale_ = false;            // some disc
  bool knowsMeasured_ = false;      // measured_ is true
};

}  // namespace palpate
