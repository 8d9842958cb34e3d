#pragma once

#include "engine/contact/carried_patch.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "shaders/shared/patch.h"

namespace palpate {

/// The pass that brings the patch to the host. A command list of its own runs it when a new patch is wanted, so that no
/// answer waits for it, and the list's fence says when the patch is whole.
class PatchFetch {
 public:
  /// As ContactOptions' of these names.
  struct Motion {
    bool pointsMove = false, normalsTurn = false;
  };
  /// `grid`: of the hash that record() is going to see. `points`: how many the cloud may have. `radius`: support
  /// radius, model units.
  PatchFetch(Device& device, const HashGrid& grid, double radius, std::uint32_t points, const Motion& motion);

  /// `velocities`: as for ContactStep.
  void record(CommandList& commands, const shared::CloudView& cloud, DeviceAddress velocities) const;
  /// Where the next run fetches; not while one is under way. Points that move are `age_s` older than their index, and
  /// what is at `centre` in that is at `now`.
  void aimAt(const Vec3& centre, double age_s, const Vec3& now);
  /// What the last run brought; until the next one begins.
  CarriedPatch patch() const;

 private:
  double reach_;
  ComputePipeline pass_;
  Buffer centre_, patch_, near_;
  Vec3 aim_{0};
};

}  // namespace palpate
