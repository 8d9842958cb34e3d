#pragma once

#include "engine/cuda/cub_hash_build.hpp"
#include "shaders/shared/edit.h"

namespace palpate::cu {

/// The push, and the refit of the normals of moved points, as shaders/edit/collect.comp and refit_normals.comp, but
/// with a pass over every point. The number of moved points never leaves the device.
class PushEdit {
 public:
  /// Measurements of the surface under the tool: sums over all edits of MeasuredPoint (shaders/shared/brush.h); may
  /// wrap around, as only differences are used.
  struct Sums {
    shared::uint weights = 0, normals[3]{}, heights = 0;
    // Results of the last edit alone.
    shared::uint seen[shared::kSheetWords]{}, nearest = shared::kOutsideSheet;
  };

  /// `radius`: support radius, model units.
  PushEdit(const shared::Brush& brush, double radius, const Stream& stream, std::uint32_t points);

  /// Sets the tool for the next edit. Only while no edit is in flight.
  void setTool(const shared::PlacedTool& tool) { tool_.host() = tool; }
  /// Only while no edit is in flight.
  const Sums& sums() const { return told_.host(); }
  /// Submits only. Pushes the points of `half`, and marks those that move.
  void recordPush(const Stream& stream, const CloudHalf& half, std::uint32_t count) const;
  /// Submits only. After the rebuild: refits the normals of the marked points and clears the marks.
  void recordRefit(const Stream& stream, const shared::CloudView& cloud) const;

 private:
  shared::Brush brush_;
  double radius_;
  unsigned refitBlocks_;
  MappedValue<shared::PlacedTool> tool_;
  MappedValue<Sums> told_;
  DeviceArray<shared::PlacedTool> toolHere_;
  DeviceArray<shared::Found> founds_;  // by id
  DeviceArray<Sums> sums_;
  DeviceArray<std::uint32_t> moved_, movedCount_;
};

}  // namespace palpate::cu
