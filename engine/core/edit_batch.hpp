#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/core/attribute_change.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// End of one action: the states since the previous mark belong to it, or it is the next of EditBatch::attributes.
struct EditMark {
  enum class Kind : std::uint8_t {
    stroke,     ///< all edits of a brush from the first in a contact until the contact was lost
    change,     ///< one call of EditStream::change(), not a stroke
    part,       ///< edits so far of a stroke that continues after received changes
    received,   ///< one call of EditStream::offer(), neither a stroke nor the end of one
    attribute,  ///< a mask, a field or a layer of strokes was changed, between strokes
    undone,     ///< that was undone
    redone      ///< and redone
  };
  std::uint64_t at = 0;  ///< number of states before it, in its batch
  Kind kind = Kind::stroke;

  bool hasAttribute() const { return kind >= Kind::attribute; }
  bool operator==(const EditMark&) const = default;
};

/// A section of a cloud's edit history: setting the points to these states, in order, gives the cloud as it was then.
/// The states of one tick name each point once. States after the last mark belong to a stroke that continues in the
/// next batch. A follower ignores the kinds of changes that it does not show, keep or send.
struct EditBatch {
  BareVector<PointState> points;
  std::vector<EditMark> marks;  ///< in order
  /// In order: one for each mark of its kind, and then what the batch's new points took from their parents.
  std::vector<AttributeChange> attributes;
  bool hasMoreThanLog = false;  ///< some of the states are not in the edit log of a back end on a GPU

  bool empty() const { return points.empty() && marks.empty() && attributes.empty(); }
  /// Number of `attributes` that belong to marks.
  std::size_t markedAttributes() const {
    return static_cast<std::size_t>(std::ranges::count_if(marks, &EditMark::hasAttribute));
  }
  void clear() {
    points.clear();
    marks.clear();
    attributes.clear();
    hasMoreThanLog = false;
  }
};

}  // namespace palpate
