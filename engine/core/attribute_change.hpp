#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/core/point_set.hpp"

namespace palpate {

/// What a mask of a layer's points means.
enum class MaskRole : std::uint8_t {
  selected,  ///< commands act on them
  hidden,    ///< not drawn
  locked,    ///< for brushes to leave as they are; none reads it yet
  within     ///< for brushes to change alone, if there are any; none reads it yet
};
inline constexpr std::size_t kMaskRoles = static_cast<std::size_t>(MaskRole::within) + 1;  // the last

/// A mask has become its symmetric difference with `points`. It is its own undo.
struct MaskFlip {
  std::uint16_t layer = 0;
  MaskRole role = MaskRole::selected;
  PointSet points;
};

/// Points have other values in a field: the present ones for a follower, those on the other side in a history.
struct FieldChange {
  std::uint16_t layer = 0;
  std::uint32_t field = 0;  ///< its number in the layer
  PointSet points;
  std::vector<std::byte> values;  ///< one for each of the points, ascending, as the field has them
};

/// A change of what a layer's points have beside their states. Further kinds are further alternatives.
using AttributeChange = std::variant<MaskFlip, FieldChange>;

}  // namespace palpate
