#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/point_state.hpp"

namespace palpate {

/// Where one thing that was done to the points ends: the states since the mark before belong to it.
struct EditMark {
  enum class Kind : std::uint8_t {
    stroke,   ///< what a brush did from its first edit in a contact until the contact was lost
    change,   ///< one call of TouchBackend::change(), which is no stroke
    part,     ///< what a brush has done so far in a stroke that goes on behind what was received
    received  ///< one call of TouchBackend::offer(), which is no stroke and ends none
  };
  std::uint64_t at = 0;  ///< number of states before it, in its batch
  Kind kind = Kind::stroke;

  bool operator==(const EditMark&) const = default;
};

/// A stretch of all that was done to a cloud's points: setting them to these states, front to back, gives the cloud as
/// it then was. The states of one tick name each point once. States behind the last mark belong to a stroke that goes
/// on in the next batch.
struct EditBatch {
  std::vector<PointState> points;
  std::vector<EditMark> marks;  ///< in order

  bool empty() const { return points.empty() && marks.empty(); }
  void clear() {
    points.clear();
    marks.clear();
  }
};

}  // namespace palpate
