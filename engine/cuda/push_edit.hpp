#pragma once

#include "engine/cuda/cub_hash_build.hpp"
#include "shaders/shared/edit.h"

namespace palpate::cu {

/// The push, the refit of the normals of moved points and their look ahead, as shaders/edit/collect.comp,
/// refit_normals.comp and request.comp without resampling, but with a pass over every point. The number of moved points
/// never leaves the device.
class PushEdit {
 public:
  /// Measurements of the surface under the tool: sums over all edits of MeasuredPoint (shaders/shared/brush.h); may
  /// wrap around, as only differences are used.
  struct Sums {
    shared::uint weights = 0, normals[3]{}, heights = 0;
    // Results of the last edit alone.
    shared::uint seen[shared::kSheetWords]{}, nearest = shared::kOutsideSheet;
    shared::uint edits = 0;  // completed by now
  };
  /// Data of an edit on the device; arrays by the points' ids.
  struct Tables {
    shared::Brush brush;
    float radius;  ///< support radius, model units
    const shared::PlacedTool* tool;
    shared::Found* founds;
    /// Number of the last edit, from 1 on, in which a point had no room; 0: none, or it has looked ahead since.
    shared::uint* blockedIn;
    const float* spacings;  ///< targets, model units
    Sums* sums;
  };

  /// `radius`: support radius; `spacings`: target of each point; model units.
  PushEdit(const shared::Brush& brush, double radius, std::span<const float> spacings, const Stream& stream);

  /// Sets the tool for the next edit. Only while no edit is in flight.
  void setTool(const shared::PlacedTool& tool) { tool_.host() = tool; }
  /// Only while no edit is in flight.
  const Sums& sums() const { return reported_.host(); }
  /// Submits only. Pushes the points of `half`, and marks those that move.
  void recordPush(const Stream& stream, const CloudHalf& half, std::uint32_t count) const;
  /// Submits only. After the rebuild: the marked points get new normals and look ahead; clears the marks.
  void recordSequel(const Stream& stream, const shared::CloudView& cloud) const;

 private:
  Tables tables() const;

  shared::Brush brush_;
  float radius_;
  unsigned movedBlocks_;
  MappedValue<shared::PlacedTool> tool_;
  MappedValue<Sums> reported_;
  DeviceArray<shared::PlacedTool> toolHere_;
  DeviceArray<shared::Found> founds_;
  DeviceArray<std::uint32_t> blockedIn_;
  DeviceArray<float> spacings_;
  DeviceArray<Sums> sums_;
  DeviceArray<std::uint32_t> moved_, movedCount_;  // slots
  DeviceArray<shared::vec4> fitted_;               // normals of the moved points
};

}  // namespace palpate::cu
