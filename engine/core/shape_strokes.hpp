#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate {

/// How many strokes there are.
struct StrokeCounts {
  std::uint64_t strokes = 0;  ///< in all
  std::uint64_t dropped = 0;  ///< of them, the oldest, which are kept no more
  std::size_t undoable = 0, redoable = 0;
  std::uint64_t version = 0;  ///< grows with each stroke, and each one that is taken back or done again
};

/// Strokes of a brush that change a shape as a whole, where no journal of points can tell it: they are taken back and
/// done again one by one.
class ShapeStrokes {
 public:
  virtual ~ShapeStrokes() = default;

  /// For the thread that asks the back end, after its finish(). False where there is none.
  virtual bool undo() = 0;
  virtual bool redo() = 0;
  /// For any thread.
  virtual StrokeCounts counts() const = 0;
};

}  // namespace palpate
