// Undo and redo of a history without a back end.
#pragma once

#include <utility>
#include <vector>

#include "engine/edit/history.hpp"

namespace palpate {

/// Carries nothing out, and collects the changes of points.
inline History::Carriers collecting(std::vector<PointChange>& changes) {
  return {.points = [&changes](std::span<const PointChange> given) {
    changes.assign(given.begin(), given.end());
    return true;
  }};
}
/// The changes that undo, or redo, the last stroke; empty if there is none.
inline std::vector<PointChange> undone(History& history) {
  std::vector<PointChange> changes;
  history.undo(collecting(changes));
  return changes;
}
inline std::vector<PointChange> redone(History& history) {
  std::vector<PointChange> changes;
  history.redo(collecting(changes));
  return changes;
}

/// The history of a shape's strokes. `Shape`: with take() and exchange(), as ShapeStrokes.
template <class Shape>
struct ShapeHistory {
  explicit ShapeHistory(Shape& shape) : shape_(shape) {}

  bool undo() {
    follow();
    return history.undo(carriers());
  }
  bool redo() {
    follow();
    return history.redo(carriers());
  }
  StrokeCounts counts() {
    follow();
    return history.counts();
  }

  History history{PointCloud(), {1 << 28}};

 private:
  History::Carriers carriers() {
    return {.shape = [this](ShapeStroke& stroke) {
      shape_.exchange(stroke);
      return true;
    }};
  }
  void follow() {
    std::vector<ShapeStroke> strokes;
    shape_.take(strokes);
    history.follow(std::move(strokes));
  }

  Shape& shape_;
};

}  // namespace palpate
