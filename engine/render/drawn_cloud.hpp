#pragma once

#include <optional>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/drawn_attributes.hpp"
#include "engine/render/drawn_gaussians.hpp"
#include "engine/render/splat_radii.hpp"

namespace palpate {

struct DrawnOptions {
  std::uint32_t spare = 0;  ///< points that edits may add
  bool painted = false;     ///< edits also set colours
  /// Mean spacing, model units (meanSpacing()): each point gets a disc that closes the surface around it. 0: points
  /// have no discs, and a frame requires a radius.
  double spacing = 0;
  bool edited = false;  ///< keeps the data needed to measure discs again after edits or motion
};

/// The drawn cloud on the GPU: the sight side's own copy, in the order of the file, so that a point's id is its index.
/// It follows the live cloud only through the edit log, or through the edits that a back end reports. All its work,
/// including its creation, uses the throughput queue.
class DrawnCloud {
 public:
  /// Normals and colours are optional. Throws OutOfGpuMemory.
  DrawnCloud(Device& device, const PointCloud& cloud, const DrawnOptions& options = {});

  /// Applies all unread entries in order on the throughput queue, waits, and consumes them; returns their number.
  std::uint64_t catchUp(EditLog::Reader& reader);
  /// The same with states from the host (EditStream::take()), first to last: for a cloud touched on another GPU,
  /// or on the CPU. Ignores states of points beyond count(). The first call may throw OutOfGpuMemory.
  std::uint64_t catchUp(std::span<const PointState> states);
  /// Its masks and its field.
  DrawnAttributes& attributes() { return attributes_; }
  const DrawnAttributes& attributes() const { return attributes_; }
  /// If all points move: takes the points of a live cloud on the same GPU, in any order, or of a frame on the host, on
  /// the throughput queue, and waits. Points beyond count() are ignored, and points missing from the input are removed.
  /// A disc is kept if its point is at or near the position where it was measured. `colored`: the live normals carry
  /// colours, as FramePipeline stores them.
  void place(const LiveCloud::Half& live, std::uint32_t slots, bool colored = false);
  void place(const CloudFrame& frame);
  /// Measures the discs of points changed by catchUp() or place() again, and those around them. Call before a frame.
  void closeSurface();

  /// Length of the arrays: the points of the file, and those that may be added. Without a point, or after its removal,
  /// the position is NaN.
  std::uint32_t count() const { return count_; }
  bool hasColors() const { return hasColors_; }
  /// Another number after each change of the points, and another one for each cloud.
  std::uint64_t stamp() const { return stamp_; }
  /// Bounds of the cloud as loaded; edits do not change them.
  const Bounds& bounds() const { return bounds_; }
  /// count vec4: xyz relative to the cloud's origin; w the bits of the id, or of kEmptySlot.
  const Buffer& positions() const { return points_.positions; }
  /// count vec4: xyz unit, or zero when unknown; w the radius of the disc, model units.
  const Buffer& normals() const { return points_.normals; }
  const Buffer& colors() const { return colors_; }  ///< count RGBA8; empty without colours
  const DiscShapes& shapes() const { return shapes_; }
  const Buffer& picked() const { return picked_; }  ///< count words: scratch memory of the rasteriser
  /// Mean spacing from the options, and the largest radius of a disc, model units; 0 without discs.
  double spacing() const { return spacing_; }
  double largestRadius() const { return largestRadius_; }
  /// Null unless the cloud was read from Gaussians.
  const DrawnGaussians* gaussians() const { return gaussians_ ? &*gaussians_ : nullptr; }
  /// Number of points as loaded, and of the indices after them that edits have used.
  std::uint32_t loadedPoints() const { return loadedPoints_; }
  std::uint32_t addedPoints() const { return end_.mapped<std::uint32_t>()[0] - loadedPoints_; }
  /// Null unless discs are measured again after edits.
  const SplatRadii* radii() const { return radii_ ? &*radii_ : nullptr; }
  std::uint64_t bytes() const;

 private:
  // A range of a ring of states on the GPU, starting at `firstSlot`.
  struct Entries {
    DeviceAddress ring = 0;
    std::uint64_t slots = 1;  // a power of two
    std::uint64_t firstSlot = 0, count = 0;
  };
  void apply(const Entries& entries);

  Device& device_;
  std::uint32_t count_, loadedPoints_;
  bool hasColors_;
  Bounds bounds_;
  double spacing_, largestRadius_ = 0;
  LiveCloud::Half points_;
  Buffer colors_, picked_;
  DrawnAttributes attributes_;
  DiscShapes shapes_;
  Buffer latest_;  // count uint32, zero between calls
  Buffer end_;     // one uint32, see CatchUpArgs
  std::optional<DrawnGaussians> gaussians_;
  std::optional<Buffer> fromHost_;        // PackedState; allocated at the first use
  std::optional<LiveCloud::Half> frame_;  // likewise
  ComputePipeline claim_, apply_, place_, leave_;
  CommandList list_;
  std::optional<SplatRadii> radii_;
  std::optional<Buffer> measured_;  // vec4, see PlaceArgs
  std::uint64_t stamp_;
  bool isStale_ = false;        // some discs must be measured again
  bool knowsMeasured_ = false;  // measured_ is valid
};

}  // namespace palpate
