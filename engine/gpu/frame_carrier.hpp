// Points that somebody moves on a GPU, for whoever reads them there.
#pragma once

#include "engine/core/vec.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class CommandList;

/// Where points that are carried are written: a vec4 a point, as a live cloud has them (LiveCloud::Half), but in the
/// order of the ids. Units are those of who reads.
struct CarriedPoints {
  DeviceAddress positions = 0;   ///< and the bits of the id
  DeviceAddress normals = 0;     ///< unit, and 0
  DeviceAddress velocities = 0;  ///< and 0
  double unitsPerMetre = 1;
  DVec3 origin{0};  ///< that positions are from, in those units
};

/// Who brings points from where it has them to where they are asked for.
class FrameCarrier {
 public:
  virtual ~FrameCarrier() = default;

  /// Records how, for the points as they are when the list runs. It may be submitted again and again, to any queue, but
  /// not while this or another such list runs, nor while the points are moved.
  virtual void recordFrame(CommandList& list, const CarriedPoints& to) const = 0;
};

}  // namespace palpate
