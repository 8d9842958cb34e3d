#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/gpu/command_list.hpp"

namespace palpate {

/// The cloud that is seen, on the GPU: the sight side's own copy, in the order of the file, so that a point's id is its
/// place. It follows the touched cloud through the edit log alone.
class DrawnCloud {
 public:
  /// Normals and colours are optional. `spare`: points that edits may add; `painted`: they give colours, too. Throws
  /// OutOfGpuMemory.
  DrawnCloud(Device& device, const PointCloud& cloud, std::uint32_t spare = 0, bool painted = false);

  /// Applies everything that is unread, in order, on the sight queue, waits for it, and consumes it; says how many
  /// entries there were.
  std::uint64_t catchUp(EditLog::Reader& reader);

  /// Places in the arrays: the points of the file, and as many as may be added. Where no point is, or one is gone, the
  /// position is no number.
  std::uint32_t count() const { return count_; }
  bool hasColors() const { return hasColors_; }
  /// Of the cloud as it was loaded; edits move points by little.
  const Bounds& bounds() const { return bounds_; }
  const Buffer& positions() const { return positions_; }  ///< count vec4: xyz relative to the cloud's origin, w 0
  const Buffer& normals() const { return normals_; }      ///< count vec4: xyz unit, or zero when unknown; w 0
  const Buffer& colors() const { return colors_; }        ///< count RGBA8; empty without colours

 private:
  Device& device_;
  std::uint32_t count_;
  bool hasColors_;
  Bounds bounds_;
  Buffer positions_, normals_, colors_;
  Buffer latest_;  // count uint32, zero between calls
  ComputePipeline claim_, apply_;
  CommandList list_;
};

}  // namespace palpate
