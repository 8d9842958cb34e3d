// The surface under the pixels of a picture, as a stroke of a pointer finds it.
#pragma once

#include <array>
#include <optional>
#include <utility>

#include "engine/render/depth_picture.hpp"

namespace palpate {

/// Depths in a picture at one position and beside it.
struct Pick {
  DVec2 place_px{0};
  double depth = 0;  ///< model units; 0: no surface
  double beside_px = 0;
  std::array<double, 4> beside{};  ///< depths beside_px to the left, right, above and below
};

/// Normal of the visible surface there, towards the eye; the direction to the eye where depths lack or the surface is
/// seen at a grazing angle.
DVec3 normalAt(const Pick& pick, const Camera& camera, const DVec2& size_px);

/// A position on the visible surface; model units relative to the cloud's origin.
struct FoundSpot {
  DVec3 place{0};
  DVec3 outward{0}, toEye{0};  ///< unit
  double depth = 0;
  double slope = 0;  ///< change of depth from pixel to pixel
};

/// A picture's depths, read once: edits do not change them.
class FoundSurface {
 public:
  /// Without depths there is no surface anywhere.
  FoundSurface() = default;
  explicit FoundSurface(DepthPicture picture) : picture_(std::move(picture)) {}

  const DepthPicture& picture() const { return picture_; }
  /// The surface under a pixel of the window; nothing beside the model.
  std::optional<FoundSpot> at(const DVec2& place_px) const;
  /// Whether the surface is interrupted between two positions that are `way_px` apart: their depths differ by more than
  /// its slope there and the distance explain, and by more than `allowed`.
  bool isStep(const FoundSpot& a, const FoundSpot& b, double way_px, double allowed) const;
  /// The position under a pixel in the plane through `spot` parallel to the picture.
  DVec3 inPlane(const FoundSpot& spot, const DVec2& place_px) const;

 private:
  DepthPicture picture_;
};

}  // namespace palpate
