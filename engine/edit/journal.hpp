#pragma once

#include <deque>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/edit_batch.hpp"

namespace palpate {

/// The edit history of a cloud, by strokes, for undo and redo: follows the edits of a TouchBackend and stores every
/// point's current state and, for each stroke, the previous state of every point that it touched. Undo and redo restore
/// exactly those states, bit by bit.
///
/// Received changes are not part of a stroke: undo and redo skip points that were changed by others since.
///
/// Undone strokes are discarded when the next stroke begins. Strokes are kept within a budget: the oldest are dropped
/// first. A stroke larger than the whole budget cannot be undone, nor can any before it.
class Journal {
 public:
  /// `file`: the cloud before the first edit. `budget_bytes`: for the strokes; the current states of the points take 40
  /// bytes each in addition. With a budget of 0 no stroke is kept.
  explicit Journal(const PointCloud& file, std::uint64_t budget_bytes = 0);

  /// Takes in edits, in order.
  void follow(const EditBatch& batch);

  /// The current states of all points, by id; new ones after the file's.
  std::span<const PointState> points() const { return points_; }
  /// Number of existing points.
  std::size_t present() const { return present_; }

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
  std::size_t undoCount() const { return done_.size(); }
  std::size_t redoCount() const { return undone_.size(); }
  /// Strokes that can no longer be undone because of the budget; of these, those larger than the whole budget.
  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t tooLarge() const { return tooLarge_; }
  /// Memory of the strokes.
  std::uint64_t bytes() const { return bytes_ + open_.points.size() * sizeof(PointState); }

 private:
  /// The points that a stroke touched, and the version, in the state on its other side: before it, or, once undone,
  /// after it.
  struct Stroke {
    std::vector<PointState> points;
    std::uint64_t version = 0;
    std::uint64_t received = 0;  // value of received_ when it was made, undone or redone last
  };
  static std::uint64_t bytesOf(const Stroke& stroke) {
    return sizeof(Stroke) + stroke.points.size() * sizeof(PointState);
  }

  void set(std::span<const PointState> states);
  void put(const PointState& state);
  void receive(std::span<const PointState> states);
  void addToStroke(std::span<const PointState> states);
  void endStroke();
  void keepBefore(std::uint32_t point);
  bool isInStroke(std::uint32_t point) const {
    return slot_[point] < open_.points.size() && open_.points[slot_[point]].number() == point;
  }
  // Computes the maximum number of points of the stroke in progress without dropping another one.
  void measureRoom();
  void growTo(std::uint32_t point);
  // Swaps the points' states with the stroke's.
  std::vector<PointChange> cross(Stroke& stroke);
  // Removes the points that others have changed since it was swapped last.
  void leaveReceived(Stroke& stroke);

  std::uint64_t budget_;
  std::vector<PointState> points_;
  std::size_t present_;
  std::vector<std::uint32_t> slot_;  // by point: its index in open_, if it is there
  std::deque<Stroke> done_;
  std::vector<Stroke> undone_;
  std::uint64_t version_ = 0, lastVersion_ = 0;
  std::uint64_t received_ = 0;               // number of received batches with any states
  std::vector<std::uint64_t> lastReceived_;  // by point: the last of these batches with it; empty before the first
  std::uint64_t bytes_ = 0;                  // of done_ and undone_
  Stroke open_;                              // the stroke in progress
  std::size_t room_ = 0;                     // maximum number of points of open_ for now
  bool inStroke_ = false, keepsStroke_ = false;
  std::uint64_t strokes_ = 0, dropped_ = 0, tooLarge_ = 0;
};

}  // namespace palpate
