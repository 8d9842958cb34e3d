#pragma once

#include "engine/core/brush.hpp"
#include "engine/cuda/cub_hash_build.hpp"
#include "shaders/shared/edit.h"

namespace palpate::cu {

/// The push and the normals of the points that it moved, as shaders/edit/collect.comp and refit_normals.comp, but with
/// a pass over every point. The number of moved points never leaves the device.
class PushEdit {
 public:
  /// `radius`: support radius; `longestMove`: of one point in one tick; model units.
  PushEdit(const BrushOptions& options, double radius, double longestMove, std::uint32_t points);

  /// Submits only. Pushes the points on `half` as the contact state says, and marks those that move.
  void recordPush(const Stream& stream, const CloudHalf& half, std::uint32_t count,
                  const shared::ContactState* state) const;
  /// Submits only. After the rebuild: refits the normals of the marked points and takes the marks away.
  void recordRefit(const Stream& stream, const shared::CloudView& cloud) const;

 private:
  BrushOptions options_;
  double radius_, longestMove_;
  unsigned refitBlocks_;
  DeviceArray<std::uint32_t> moved_, movedCount_;
};

}  // namespace palpate::cu
