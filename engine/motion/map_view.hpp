#pragma once

#include <vector>

#include "engine/motion/surfel_map.hpp"

namespace palpate {

/// Which point of a map stands in front in each pixel of a camera: the index image.
struct MapView {
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;
  shared::FusionView view{};       ///< of the camera that it is seen by
  std::vector<std::uint32_t> ids;  ///< row by row; kNoPoint where there is none
};

/// Points that face the camera; of two in a pixel the nearer, and of equally near ones the one of the lower id. Into
/// memory that is used again.
void viewMap(const SurfelMap& map, const shared::FusionView& view, MapView& image);

}  // namespace palpate
