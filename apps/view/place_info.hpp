// The model at a position that the user has picked.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/view/measure.hpp"

namespace palpate {

class WindowSession;

struct PlaceInfo {
  DVec3 place{0};                      ///< picked position, file coordinates
  double resolution = 0;               ///< of `place` (coordinateText())
  std::optional<std::uint32_t> point;  ///< id of the nearest point; nothing for a model that moves
  DVec3 position{0};                   ///< of that point, file coordinates
  double positionResolution = 0;       ///< 0: exactly as in the file, in double precision
  DVec3 normal{0};                     ///< unit
  std::vector<std::pair<std::string, std::string>> attributes;  ///< names and values as in the file
  /// Stiffness that a hand feels there along the normal, N/mm, and its cause; nothing where it is unknown.
  std::optional<double> stiffness_N_mm;
  std::string stiffnessOf;
};

/// A position under the cursor, model units relative to the cloud's origin, of which a pixel is `pixel` wide there: the
/// nearest point within 5 pixels, else the position, rounded to the pixel. Iterates over all points.
PickedPosition pickedAt(const WindowSession& session, const DVec3& place, double pixel);

/// Iterates over all points.
PlaceInfo placeInfo(const WindowSession& session, const PickedPosition& picked);

}  // namespace palpate
