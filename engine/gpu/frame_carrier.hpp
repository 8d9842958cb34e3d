// Interface to copy moving points on a GPU from their source to a reader.
#pragma once

#include "engine/core/vec.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class CommandList;

/// Destination of the points: a vec4 per point, as in a live cloud (LiveCloud::Half), but in the order of the ids.
/// Units are those of the reader.
struct CarriedPoints {
  DeviceAddress positions = 0;   ///< w: the bits of the id
  DeviceAddress normals = 0;     ///< unit; w: 0
  DeviceAddress velocities = 0;  ///< w: 0
  double unitsPerMetre = 1;
  DVec3 origin{0};  ///< origin of the positions, in those units
};

/// A source that copies its points to a destination.
class FrameCarrier {
 public:
  virtual ~FrameCarrier() = default;

  /// Records the copy of the points as they are when the list runs. The list may be submitted repeatedly, to any queue,
  /// but not while it or another such list runs, nor while the points are moved.
  virtual void recordFrame(CommandList& list, const CarriedPoints& to) const = 0;
};

}  // namespace palpate
