#pragma once

#include "engine/contact/carried_patch.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "shaders/shared/patch.h"

namespace palpate {

/// The pass that copies the patch to the host. It runs in its own command list when a new patch is needed, so that no
/// answer waits for it; the list's fence signals that the patch is complete.
class PatchFetch {
 public:
  /// As the members of ContactOptions.
  struct Motion {
    bool pointsMove = false, normalsTurn = false;
  };
  /// `grid`: of the hash used in record(). `points`: maximum number of points of the cloud. `radius`: support radius,
  /// model units.
  PatchFetch(Device& device, const HashGrid& grid, double radius, std::uint32_t points, const Motion& motion);

  /// `velocities`: as for ContactStep.
  void record(CommandList& commands, const shared::CloudView& cloud, DeviceAddress velocities) const;
  /// Sets the position of the next fetch; not during a run. Moving points are `age_s` older than their index; `centre`
  /// is a position in the index, which has moved to `now`.
  void aimAt(const Vec3& centre, double age_s, const Vec3& now);
  /// The patch of the last run; valid until the next run starts.
  CarriedPatch patch() const;

 private:
  double reach_;
  ComputePipeline pass_;
  Buffer centre_, patch_, near_;
  Vec3 aim_{0};
};

}  // namespace palpate
