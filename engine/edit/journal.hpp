#pragma once

#include <deque>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/edit_batch.hpp"

namespace palpate {

/// What was done to a cloud, stroke by stroke, and how to take it back: follows the edits of a TouchBackend, knows
/// every point as it is, and for each stroke every point that it touched as it was before. Undo and redo give back
/// exactly those states, bit by bit.
///
/// What others have done is in no stroke: a point that they have changed since is left as it is by undo and redo.
///
/// A stroke that was undone and not redone is forgotten as soon as the next one begins. Strokes are kept as long as
/// they fit into a budget: the oldest are dropped first, and a stroke that is larger than the whole budget cannot be
/// undone, nor can any before it.
class Journal {
 public:
  /// `file`: the cloud before the first edit. `budget_bytes`: for the strokes; the points as they are now take 40 bytes
  /// each besides. With a budget of 0 no stroke is kept.
  explicit Journal(const PointCloud& file, std::uint64_t budget_bytes = 0);

  /// Takes in what was done, in order.
  void follow(const EditBatch& batch);

  /// All points as they are, by id; those that came later stand behind the file's.
  std::span<const PointState> points() const { return points_; }
  /// Of them, those that are there.
  std::size_t present() const { return present_; }

  /// What takes the last stroke back, each point once; nothing where there is none. Hand it to the back end's change(),
  /// and what that tells of it to follow(), before any other edit. Only between strokes: when every edit so far has
  /// been taken in, and inStroke() is false (change() with nothing to change ends a stroke).
  std::vector<PointChange> undo();
  /// The same for the stroke that was undone last.
  std::vector<PointChange> redo();

  /// Tells states of the points apart: it is the same again exactly when they are, by undo and redo.
  std::uint64_t version() const { return version_ + (received_ << 32); }

  bool inStroke() const { return inStroke_; }
  std::uint64_t strokes() const { return strokes_; }  ///< that have ended, ever
  std::size_t undoable() const { return done_.size(); }
  std::size_t redoable() const { return undone_.size(); }
  /// Strokes that can no longer be undone because of the budget; of them, those larger than all of it.
  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t tooLarge() const { return tooLarge_; }
  /// What the strokes take now.
  std::uint64_t bytes() const { return bytes_ + open_.points.size() * sizeof(PointState); }

 private:
  /// The points that a stroke touched, and the version, each as it was on the other side of it: before, or, once
  /// undone, after.
  struct Stroke {
    std::vector<PointState> points;
    std::uint64_t version = 0;
    std::uint64_t received = 0;  // when it was made, undone or redone last
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
  // The most points that the stroke under way may have without dropping another one.
  void measureRoom();
  void growTo(std::uint32_t point);
  // Exchanges the points' states with the stroke's.
  std::vector<PointChange> cross(Stroke& stroke);
  // Leaves out of it the points that others have changed since it was crossed last.
  void leaveReceived(Stroke& stroke);

  std::uint64_t budget_;
  std::vector<PointState> points_;
  std::size_t present_;
  std::vector<std::uint32_t> slot_;  // by point: where it stands in open_, if it is there
  std::deque<Stroke> done_;
  std::vector<Stroke> undone_;
  std::uint64_t version_ = 0, lastVersion_ = 0;
  std::uint64_t received_ = 0;               // batches of what others have done, that have any states
  std::vector<std::uint64_t> lastReceived_;  // by point: the last one of those that had it; empty before the first
  std::uint64_t bytes_ = 0;                  // of done_ and undone_
  Stroke open_;                              // under way
  std::size_t room_ = 0;                     // points that open_ may have for now
  bool inStroke_ = false, keepsStroke_ = false;
  std::uint64_t strokes_ = 0, dropped_ = 0, tooLarge_ = 0;
};

}  // namespace palpate
