#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A node of a body and its displacement, m: in the rest shape from the lattice, or of a request, or of a stroke.
struct RestPlace {
  std::uint32_t node = 0;
  Vec3 moved{0};

  bool operator==(const RestPlace&) const = default;
};

/// The nodes whose rest places a brush stroke changed, as they are on its other side: before it, or, once undone, after
/// it.
struct ShapeStroke {
  std::vector<RestPlace> places;
};

/// The brush strokes of a body's rest shape. They change a shape as a whole, and move no points by themselves.
class ShapeStrokes {
 public:
  virtual ~ShapeStrokes() = default;

  /// Appends the strokes that have ended since the last call, in order. For any thread.
  virtual void take(std::vector<ShapeStroke>& strokes) = 0;
  /// Exchanges a stroke's places with those of the shape, bit by bit. For the thread that queries the back end, after
  /// its finish().
  virtual void exchange(ShapeStroke& stroke) = 0;
};

}  // namespace palpate
