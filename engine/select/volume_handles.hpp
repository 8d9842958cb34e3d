// The handles of a volume in the picture, which the mouse drags. Positions are model units relative to the cloud's
// origin, pixels those of the window from the top left corner.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/render/camera.hpp"
#include "engine/select/volume.hpp"

namespace palpate {

/// centre: moves the volume parallel to the picture; arrow: along an axis; side: moves one side of a box; ring: rotates
/// about an axis; size: makes everything larger.
struct VolumeHandle {
  enum class Kind : std::uint8_t { centre, arrow, side, ring, size };
  Kind kind = Kind::centre;
  int axis = 0;
  double sign = 1;

  bool operator==(const VolumeHandle&) const = default;
};

/// A volume, and what its handles are for.
struct HandledVolume {
  Volume volume;
  bool movesPoints = false;  ///< it is the box of points that move with it

  std::vector<VolumeHandle> handles() const;
  /// Of a handle, in the model.
  DVec3 placeOf(const VolumeHandle& handle, const Camera& camera) const;
  /// The handle nearest to `cursor_px`, within some pixels.
  std::optional<VolumeHandle> handleAt(const DVec2& cursor_px, const Camera& camera, const DVec2& size_px) const;
  /// The volume after the mouse has dragged a handle.
  Volume dragged(const VolumeHandle& handle, const Camera& camera, const DVec2& size_px, const DVec2& from_px,
                 const DVec2& to_px) const;
  /// Its outline, and a line to each arrow.
  std::vector<std::array<DVec3, 2>> edges(const Camera& camera) const;
};

}  // namespace palpate
