#pragma once

#include "engine/core/edit_batch.hpp"
#include "engine/edit/point_states.hpp"
#include "engine/edit/undo_list.hpp"

namespace palpate {

/// The points that a stroke touched, and the version, in the state on its other side: before it, or, once undone, after
/// it.
struct PointStroke {
  std::vector<PointState> points;
  std::uint64_t version = 0;
  std::uint64_t received = 0;  ///< number of received batches when it was made, undone or redone last
};
inline std::uint64_t bytesOf(const PointStroke& stroke) {
  return sizeof(PointStroke) + stroke.points.size() * sizeof(PointState);
}

/// The edit history of a cloud, by strokes, for undo and redo: follows the edits of a TouchBackend and keeps the
/// present states of the points and, for each stroke, the previous state of every point that it touched. Undo and redo
/// restore exactly those states, bit by bit.
///
/// Received changes are not part of a stroke: undo and redo skip points that were changed by others since. A stroke
/// larger than the whole budget cannot be undone, nor can any before it.
class Journal {
 public:
  /// `file`: the cloud before the first edit. `budget_bytes`: for the strokes; with 0 no stroke is kept.
  explicit Journal(const PointCloud& file, std::uint64_t budget_bytes = 0)
      : points_(file), undoList_(budget_bytes), slot_(budget_bytes ? points_.size() : 0) {}

  /// Takes in edits, in order.
  void follow(const EditBatch& batch);

  const PointStates& points() const { return points_; }
  /// The finished strokes.
  const UndoList<PointStroke>& undoList() const { return undoList_; }

  /// The changes that undo the last stroke, each point once; empty if there is none. The caller passes them to the back
  /// end's change(), and the resulting edits to follow(), before any other edit. Only between strokes: when all edits
  /// so far have been taken in and inStroke() is false (change() without changes ends a stroke).
  std::vector<PointChange> undo();
  /// The same for the stroke undone last.
  std::vector<PointChange> redo();

  /// Identifies the state of the points: undo and redo restore the version together with the states.
  std::uint64_t version() const { return version_ + (received_ << 32); }

  bool inStroke() const { return inStroke_; }
  std::uint64_t strokes() const { return strokes_; }  ///< finished so far

 private:
  void receive(std::span<const PointState> states);
  void addToStroke(std::span<const PointState> states);
  void endStroke();
  void keepBefore(std::uint32_t point);
  bool isInStroke(std::uint32_t point) const {
    return point < slot_.size() && slot_[point] < open_.points.size() && open_.points[slot_[point]].number() == point;
  }
  // Swaps the points' states with the stroke's.
  std::vector<PointChange> cross(PointStroke& stroke);
  // Removes the points that others have changed since it was swapped last.
  void leaveReceived(PointStroke& stroke);

  PointStates points_;
  UndoList<PointStroke> undoList_;
  PointStroke open_;                 // the stroke in progress
  std::vector<std::uint32_t> slot_;  // by point: its index in open_, if it is there
  std::uint64_t version_ = 0, lastVersion_ = 0;
  std::uint64_t received_ = 0;               // number of received batches with any states
  std::vector<std::uint64_t> lastReceived_;  // by point: the last of these batches with it; empty before the first
  bool inStroke_ = false, keepsStroke_ = false;
  std::uint64_t strokes_ = 0;
};

}  // namespace palpate
