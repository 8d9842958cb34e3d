#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"

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

/// A point whose strength in a layer of strokes is not the layer's, since it was locked when that was changed.
struct HeldPoint {
  std::uint64_t number = 0;
  double strength = 1;

  bool operator==(const HeldPoint&) const = default;
};

/// How a layer of strokes is set. Its number is its index in the order in which layers of strokes were made.
struct StrokeLayer {
  std::string name;
  double strength = 1;               ///< of its strokes: with 0 the points are as before them, with 1 as after them
  bool isHidden = false;             ///< as with strength 0
  bool isMerged = false;             ///< its strokes stay as they are: it is not listed, and cannot be changed
  std::vector<HeldPoint> held = {};  ///< ascending by number

  double shown() const { return isHidden ? 0 : strength; }
  bool operator==(const StrokeLayer&) const = default;
};
/// A point before and after strokes of a layer in a row, between which nothing else has changed it.
struct StrokeLayerPoint {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  PointState before;  ///< of a point that they inserted: its parent before them, gone
  PointState after;
  std::uint32_t earlier = kNone;  ///< index of the strokes before, if something else has changed it since; or kNone

  bool operator==(const StrokeLayerPoint&) const = default;
};
/// Where a layer of strokes has a point at strength 0, at 1 and in between: positions and normals.
struct LayerPlace {
  enum class Kind : std::uint8_t {
    kept,      ///< it exists before and after the strokes
    inserted,  ///< it does not exist at exactly 0
    merged,    ///< it exists at 0, and in between where the others are sparse
    cut        ///< it exists up to a half
  };
  std::uint64_t number = 0;
  Vec3 one{0}, oneNormal{0};
  Vec3 base{0};  ///< in between it is on the line from here to `one`
  /// Of a merged or a cut point, which is at `base` at 0: where it is kept at exactly 1, when it does not exist.
  Vec3 zero{0};
  Vec3 zeroNormal{0};
  Kind kind = Kind::kept;
  std::uint8_t isSeen = 1;  ///< 0: something else has removed it
  std::uint16_t none = 0;

  bool operator==(const LayerPlace&) const = default;
};
static_assert(sizeof(LayerPlace) == 72);  // without gaps, as it is in logs

/// A layer of strokes is set otherwise, or was made, or removed: a layer is made and removed at the end of the list.
struct StrokeLayerChange {
  /// What the next states of points are, which belong to the same entry of the history.
  enum class Points : std::uint8_t {
    none,            ///< others
    slide,           ///< moved by the strength
    slideContinued,  ///< likewise, in the entry of the slide before: both are one drag of a user
    strokes          ///< a stroke of the layer, undone or redone
  };
  std::uint16_t layer = 0;   ///< of the scene
  std::uint32_t number = 0;  ///< of the layer of strokes
  bool isPresent = true;     ///< from now on for a follower, on the other side in a history
  StrokeLayer set;
  std::optional<std::uint32_t> open;  ///< number of the layer that strokes become part of, from now on
  Points moves = Points::none;
  std::vector<StrokeLayerPoint> points;  ///< of a layer that is made
  BareVector<LayerPlace> places;         ///< likewise, if its strength has been changed; ascending by number

  bool operator==(const StrokeLayerChange&) const = default;
};

/// A change of what a layer's points have beside their states. Further kinds are further alternatives.
using AttributeChange = std::variant<MaskFlip, FieldChange, FieldPresence, StrokeLayerChange>;

}  // namespace palpate
