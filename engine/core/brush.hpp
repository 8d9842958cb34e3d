#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/core/vec.hpp"
#include "shaders/shared/brush_traits.h"

namespace palpate {

/// The positions x with dot(normal, x) = height, relative to the cloud's origin, model units.
struct MirrorPlane {
  DVec3 normal{1, 0, 0};  ///< unit
  double height = 0;

  DVec3 image(const DVec3& position) const { return position - 2 * (glm::dot(normal, position) - height) * normal; }
  DVec3 imageOfDirection(const DVec3& way) const { return way - 2 * glm::dot(normal, way) * normal; }
  bool operator==(const MirrorPlane&) const = default;
};

/// A brush and its settings. Every brush acts only while the HIP is deeper than `yieldDepth` behind the proxy and does
/// not withdraw. Its tool is fixed to the hand and perpendicular to the surface as the stroke found it (BrushStroke).
/// Push and carve use a ball with a shaft of the same width, whose tip is the yield depth before the HIP; the other
/// brushes act around the position where the surface was found over the hand. All brushes but carve leave parts that
/// are not connected with the surface under the hand unchanged, and all but carve and grab a side of the model that
/// faces away. With all but carve and paint a point moves only as far as it has seen, if it is resampled.
struct BrushOptions {
  BrushKind kind = BrushKind::push;
  double yieldDepth = 0;  ///< depth of the HIP behind the proxy from which the surface yields, model units
  double pushRate = 0;    ///< push: share of the distance to its target that a point moves in one tick, 0 to 1
  double radius = 0;      ///< of the brush's ball, model units
  /// All but push: share of the full effect applied in one tick, 0 to 1; for all but carve, at the centre of the brush.
  /// The full effect is, for carve, the path to the brush; for smooth and flatten, the path to the surface and, from
  /// where the stroke found the point, to the plane; for grab, the path of the hand since it took hold, up to two
  /// radii; for inflate, a thousandth of the brush's radius until the surface is raised by as much as the hand presses;
  /// for paint, the colour.
  double strength = 0.5;
  /// All but push and carve: falloff of the effect towards the rim, (1 - r^2)^falloff, with r the distance in brush
  /// radii. An integer, so that every processor computes the same result; 0 is a hard rim, kMaxFalloff the maximum.
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 4> color{255, 0, 0, 255};  ///< paint: RGBA, 0 to 255
  bool resample = true;  ///< points are inserted where the surface is stretched and merged where it is crowded
  /// Inflate: a stroke that passes over points again, or rests, raises them on; without, by as much as the hand
  /// presses. Push, carve, flatten and grab follow the hand itself, smooth and paint always accumulate.
  bool accumulate = false;
  /// Each edit is also made by the mirror image of the tool (MirroredStroke); empty: by the hand's tool alone.
  std::optional<MirrorPlane> symmetry;

  bool operator==(const BrushOptions&) const = default;
};
constexpr std::uint32_t kMaxFalloff = 16;

}  // namespace palpate
