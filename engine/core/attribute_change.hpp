#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/point_set.hpp"

namespace palpate {

/// What a mask of a layer's points means.
enum class MaskRole : std::uint8_t {
  selected,  ///< commands act on them
  hidden,    ///< neither drawn nor felt
  locked,    ///< brushes leave them as they are
  within     ///< if there are any, brushes change no others
};
inline constexpr std::size_t kMaskRoles = static_cast<std::size_t>(MaskRole::within) + 1;  // the last

/// A mask has become its symmetric difference with `points`. It is its own undo.
struct MaskFlip {
  std::uint16_t layer = 0;
  MaskRole role = MaskRole::selected;
  PointSet points;

  bool operator==(const MaskFlip&) const = default;
};

/// Points have other values in a field: the present ones for a follower, those on the other side in a history.
struct FieldChange {
  std::uint16_t layer = 0;
  std::uint32_t field = 0;  ///< its number in the layer
  PointSet points;
  std::vector<std::byte> values;  ///< one for each of the points, ascending, as the field has them

  bool operator==(const FieldChange&) const = default;
};

/// A field was made, or removed. Fields are made and removed at the end of the list of a layer's fields.
struct FieldPresence {
  std::uint16_t layer = 0;
  std::uint32_t field = 0;  ///< its number in the layer
  bool isPresent = true;    ///< from now on for a follower, on the other side in a history
  std::string name, unit;
  std::uint8_t type = 0;          ///< a ScalarType
  std::uint64_t points = 0;       ///< that have a number
  std::vector<std::byte> values;  ///< of a field that is made: one for each of these points; empty: zeros

  bool operator==(const FieldPresence&) const = default;
};

/// A change of what a layer's points have beside their states. Further kinds are further alternatives.
using AttributeChange = std::variant<MaskFlip, FieldChange, FieldPresence>;

}  // namespace palpate
