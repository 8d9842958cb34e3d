#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate {

/// Counts of strokes.
struct StrokeCounts {
  std::uint64_t strokes = 0;  ///< total
  std::uint64_t dropped = 0;  ///< of these, the oldest ones, which are no longer kept
  std::size_t undoCount = 0, redoCount = 0;
  std::uint64_t version = 0;  ///< grows with each stroke, undo and redo
};

/// Brush strokes that change a shape as a whole, which a journal of points cannot record. They are undone and redone
/// one by one.
class ShapeStrokes {
 public:
  virtual ~ShapeStrokes() = default;

  /// For the thread that queries the back end, after its finish(). False if there is no such stroke.
  virtual bool undo() = 0;
  virtual bool redo() = 0;
  /// For any thread.
  virtual StrokeCounts counts() const = 0;
};

}  // namespace palpate
