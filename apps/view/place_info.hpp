// What the model is at a place that a person has picked.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

class WindowSession;

struct PlaceInfo {
  DVec3 place{0};                      ///< that was picked, file coordinates
  double resolution = 0;               ///< of it (coordinateText())
  std::optional<std::uint32_t> point;  ///< the nearest point's number; nothing where points move by themselves
  DVec3 position{0};                   ///< of that point, file coordinates
  double positionResolution = 0;       ///< 0: as the file has it, in double precision
  DVec3 normal{0};                     ///< unit
  std::vector<std::pair<std::string, std::string>> attributes;  ///< by their names, as the file has them
  /// That a hand feels there in the normal's direction, N/mm, and what it comes of; nothing where nobody can say.
  std::optional<double> stiffness_N_mm;
  std::string stiffnessOf;
};

/// `place`: model units relative to the cloud's origin. Looks at all points.
PlaceInfo placeInfo(const WindowSession& session, const DVec3& place);

}  // namespace palpate
