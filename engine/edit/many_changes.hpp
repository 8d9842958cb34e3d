#pragma once

#include <optional>
#include <span>

#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/spatial/live_cloud.hpp"

namespace palpate {

/// Changes many points of a live cloud at once: the GPU moves those that stay as they are, so that only changed ones
/// are uploaded.
class ManyChanges {
 public:
  explicit ManyChanges(Device& device);

  /// Writes to the back half of `cloud`, in the order of their ids, the points of its front half but for those of
  /// `changed`, and those of `changed` that exist in `states`, by number, but for `without`. `tables`: of the points
  /// (shared::PointTables). The caller flips the cloud and builds its index. Waits for the latency queue.
  void carryOut(const LiveCloud& cloud, const Buffer& tables, const PointSet& changed,
                std::span<const PointState> states, const PointSet& without);

 private:
  /// Points in memory of the host that the GPU reads.
  struct SentPoints {
    Buffer positions, normals, colors;
  };

  Device& device_;
  ComputePipeline place_;
  // Kept, since their allocation takes longer than a copy of the points.
  std::optional<Buffer> changed_;  // a bit for each point, likewise in memory of the host
  std::optional<SentPoints> sent_;
};

}  // namespace palpate
