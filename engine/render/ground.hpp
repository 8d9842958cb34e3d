#pragma once

#include <cstdint>
#include <utility>

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_constants.hpp"
#include "shaders/shared/look.h"

namespace palpate {

/// The map of the ground below a box whose points are `spacing` apart, model units: on the lowest side of the box along
/// `up` (unit, along an axis), with room around it for the shadow. No cell is finer than the points.
shared::GroundMap groundMap(const Bounds& bounds, const DVec3& up, double spacing);

/// The soft shadow of a model on the ground below it: a map of heights, and of the sky that they hide, made again only
/// after the model has changed; it darkens the background where the ground is in shadow.
class Ground {
 public:
  explicit Ground(Device& device);

  /// Makes the map again if the points or triangles, or the map, differ from those of the last call.
  void follow(CommandList& list, const DrawnCloud& cloud, const shared::GroundMap& map);
  void follow(CommandList& list, const DrawnMesh& mesh, const shared::GroundMap& map);
  /// Darkens `shaded` (ShadeArgs) of samples without a surface.
  void recordShadow(CommandList& list, DeviceAddress source, DeviceAddress depth, DeviceAddress shaded,
                    std::uint64_t samples) const;

  /// One float per cell of the map: share of the sky that is hidden.
  const Buffer& shadow() const { return shadow_; }

 private:
  void make(CommandList& list, const shared::GroundHeightsArgs& args);

  ComputePipeline heights_, hide_, blur_, darken_;
  Buffer heightMap_, rough_, shadow_;
  shared::GroundMap map_{};
  std::pair<std::uint64_t, std::uint64_t> made_{0, 0};  // stamps of the points that the map is of; 0: of none
};

}  // namespace palpate
