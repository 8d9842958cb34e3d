#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/splat_index.hpp"
#include "shaders/shared/splat_radius.h"

namespace palpate {

/// What discs have cost since the cloud was loaded.
struct DiscWork {
  std::uint64_t builds = 0;    ///< of the whole index
  std::uint64_t searches = 0;  ///< among all points for discs to be measured
  std::uint64_t measured = 0;  ///< discs
  std::uint64_t cells = 0;     ///< changed ones, around which discs were searched
  std::uint64_t clears = 0;    ///< of the marks of all buckets
};

/// What is known of discs beside their radii.
struct DiscShapes {
  explicit DiscShapes(Device& device, std::uint32_t places);
  std::uint64_t bytes() const { return clips.bytes() + widths.bytes(); }

  Buffer clips;   ///< a word for each index: where the disc is clipped, packHalf2x16
  Buffer widths;  ///< a word for each shared::kDiscBlock indices: bits of the largest radius ever measured, model units
};

/// Measures the radius that each point's disc needs to close the surface around it (shaders/shared/splat_radius.h).
/// Works on the throughput queue and waits.
class SplatRadii {
 public:
  /// `places`: maximum number of points; `spacing`: mean, model units, positive. Borders farther than a tenth of the
  /// box are ignored. `edited`: with the memory to follow edits. `positions`: of
  /// points in the order of their ids, which tell how the index is sorted fastest.
  SplatRadii(Device& device, const Bounds& bounds, std::uint32_t places, double spacing, bool edited = false,
             std::span<const Vec3> positions = {});

  /// Writes the radius of every point (model units) into the w of its normal, and the rest of its disc into `shapes`.
  /// `points`: in the order of their ids, with ids in the w of their positions.
  void measure(const LiveCloud::Half& points, const DiscShapes& shapes);
  /// The same only for points with changes near them since the last call; the result equals that of measure(). At a
  /// cost of the changed points, if the index has followed them.
  void measureChanged(const LiveCloud::Half& points, const DiscShapes& shapes);

  SplatIndex& index() { return index_; }
  const SplatIndex& index() const { return index_; }
  const HashGrid& grid() const { return index_.grid(); }
  /// One bit per bucket of the grid, set when a point in it is added, removed, moved or rotated.
  const Buffer& changed() const { return changed_; }
  /// Largest radius ever measured, model units.
  double largest() const;
  const DiscWork& work() const { return work_; }
  std::uint64_t bytes() const;

 private:
  // List the points to be measured again, and return their number: by their distance from changed cells, empty if that
  // is not enough, or by the buckets that they have visited, among all points.
  std::optional<std::uint32_t> listNear();
  std::uint32_t listAmongAll(const LiveCloud::Half& points);
  void recordAmongAll(CommandList& list) const;
  enum class Discs { all, listedNear, listedAmongAll };
  void measure(const LiveCloud::Half& points, const DiscShapes& shapes, std::uint32_t count, Discs which);
  void recordClearMarks(CommandList& list, Discs which);

  Device& device_;
  std::uint32_t places_;
  double spacing_, widest_;
  SplatIndex index_;
  ComputePipeline pass_, changedPass_;
  Buffer reaches_, changed_;
  Buffer largest_, largestRead_;             // largest radius and reach
  Buffer changedSlots_, count_, countRead_;  // points that are measured again
  CommandList list_;
  DiscWork work_;
};

}  // namespace palpate
