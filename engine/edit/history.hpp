#pragma once

#include <functional>
#include <optional>
#include <variant>

#include "engine/core/edit_batch.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/edit/point_states.hpp"
#include "engine/edit/stroke_layers.hpp"
#include "engine/edit/undo_list.hpp"

namespace palpate {

/// The points that a stroke touched, in the state on its other side: before it, or, once undone, after it.
struct PointStroke {
  BareVector<PointState> points;
  std::uint64_t received = 0;              ///< number of received batches when it was made, undone or redone last
  std::optional<std::uint32_t> layer;      ///< of strokes, that it is part of
  bool isGiven = false;                    ///< changeMany()
  std::optional<StrokeLayerChange> slide;  ///< of a layer of strokes, that has moved the points: on the other side
};
/// Points that a stroke has removed or restored, and changed in nothing else: it is its own undo. Of 25 million points
/// it takes megabytes, where their states take a gigabyte.
struct PresenceStroke {
  PointSet points;
  std::uint64_t received = 0;  ///< as PointStroke
};
/// As changes, where the states are those after it. All points are known.
std::vector<PointChange> presenceChanges(const PointSet& points, const PointStates& after);

/// One entry of a history: a change of one kind, and the version on its other side.
struct HistoryChange {
  std::variant<PointStroke, ShapeStroke, PresenceStroke, AttributeChange> what;
  std::uint64_t version = 0;
};
std::uint64_t bytesOf(const HistoryChange& change);
/// To bytes for KeptChanges, and back; false if they are not those of a change.
std::vector<std::byte> pack(const HistoryChange& change);
bool unpack(std::span<const std::byte> bytes, HistoryChange& change);

/// Counts of strokes.
struct StrokeCounts {
  std::uint64_t strokes = 0;   ///< total
  std::uint64_t dropped = 0;   ///< of these, those that can no longer be undone because of the budget
  std::uint64_t tooLarge = 0;  ///< of them, those larger than the whole budget
  std::size_t undoCount = 0, redoCount = 0;
  std::uint64_t version = 0;  ///< History::version()
};

/// The history of a session: what was changed, in order, for undo and redo. Each kind of change stores the other side
/// of what it has changed, so that undo and redo restore exactly that, bit by bit; further kinds are further
/// alternatives of HistoryChange. It follows the edits of a TouchBackend and keeps the present states of the points.
///
/// Received changes are not part of a stroke: undo and redo skip points that were changed by others since. A stroke
/// larger than the whole budget cannot be undone, nor can any before it. For one thread.
class History {
 public:
  /// `file`: the cloud before the first edit.
  explicit History(const PointCloud& file, const UndoBudget& budget = {}) : History(PointStates(file), budget) {}
  /// Strokes become part of the open one of these layers, which must outlive it, and undo and redo follow in them.
  void setStrokeLayers(StrokeLayers& layers) { layers_ = &layers; }
  /// `points`: before the first edit. If only a part of the cloud is known, edits report the state of a point before
  /// its first edit as received, which does not count as a change by others.
  explicit History(PointStates points, const UndoBudget& budget = {});

  /// Takes in edits, in order. `hasLast`: the states of the last action that has some are here already, by
  /// changePresence() or changeMany(), or by undo() or redo() of many.
  void follow(const EditBatch& batch, bool hasLast = false);
  /// Takes in strokes of a body's shape.
  void follow(std::vector<ShapeStroke> strokes);
  /// Makes a change of a mask or a field, between strokes: `exchange` carries it out, and leaves what undoes it. If
  /// that throws, nothing has changed.
  void make(AttributeChange change, const std::function<void(AttributeChange&)>& exchange);

  /// Carries changes of these points out, which points() has already; `changes` makes them one by one. False, or an
  /// exception: they are not carried out.
  using MadeChanges = std::function<std::vector<PointChange>()>;
  using CarryMany = std::function<bool(const PointSet& points, const MadeChanges& changes)>;
  /// Makes a stroke that removes existing points and restores others, between strokes: `carry` carries it out. If that
  /// throws, nothing has changed.
  void changePresence(const PointSet& points, const CarryMany& carry);
  /// Makes a stroke that brings many known points, each once, to these states, likewise.
  void changeMany(BareVector<PointState> states, const CarryMany& carry);

  /// Sets a layer of strokes so, and its points, between strokes: one stroke, or more of the slide before. `carry`
  /// carries out the changes of the points that exist before or after, if there are any; `change` is as it was carried
  /// out then. If it throws, nothing has changed. `lock`: as StrokeLayers::slide(). `recorded`: these states, in place
  /// of those that the layer has.
  void slide(StrokeLayerChange& change, const PointLock* lock, const CarryMany& carry,
             std::optional<std::span<const PointState>> recorded = std::nullopt);

  const PointStates& points() const { return points_; }

  /// Carries a change out, which points() has already: of points, each of them once, and reports the resulting edits
  /// before any other; or of a shape, a mask or a field, by exchange. False, or an exception: nothing has changed.
  struct Carriers {
    std::function<bool(std::span<const PointChange>)> points;
    CarryMany many = nullptr;  ///< of points that vanish or reappear, or of many others; null: by `points`
    std::function<bool(ShapeStroke&)> shape;
    std::function<bool(AttributeChange&)> attributes;
    /// Called once a stroke of a layer of strokes, or a slide, is undone or redone: how the layer is set now, and what
    /// `points` has carried out.
    std::function<void(StrokeLayerChange)> layers = nullptr;
  };
  /// Undoes the last change. False if there is none, or if it was not carried out; then, and if that throws, the
  /// history is unchanged. Only between strokes: when all edits so far have been taken in and inStroke() is false
  /// (EditStream::change() without changes ends a stroke).
  bool undo(const Carriers& carriers);
  /// The same for the change undone last.
  bool redo(const Carriers& carriers);
  /// The change that undo() takes next; null: none.
  const HistoryChange* last() const { return list_.last(); }
  /// The same as undo() of a stroke, which then was never made: it cannot be redone, nor is it counted.
  bool takeBack(const Carriers& carriers);

  StrokeCounts counts() const;
  /// Identifies the state of the points, the shape and the fields, which a file can have: undo and redo restore the
  /// version together with the states. A mask is in no file.
  std::uint64_t version() const { return version_ + (received_ << 32); }
  bool inStroke() const { return inStroke_; }
  /// The stroke in progress can be undone once it has ended.
  bool isKeepingStroke() const { return inStroke_ && keepsStroke_; }
  /// Memory of the changes.
  std::uint64_t bytes() const { return list_.bytes(); }

 private:
  void receive(std::span<const PointState> states);
  void addToStroke(std::span<const PointState> states);
  void beginStroke();
  // Whether these states are one whole stroke that removes or restores points; then it is kept.
  bool addPresence(std::span<const PointState> states);
  void endStroke();
  // Calls carry(), with the points as after the change; if that fails, they are as before. The states of a stroke are
  // exchanged with the present ones; a slide also changes points that do not exist before and after, which concerns
  // the history alone.
  bool carryPresence(const PointSet& points, const CarryMany& carry);
  bool carryStates(BareVector<PointState>& states, PointSet points, bool hasAbsent, const CarryMany& carry);
  void keepBefore(std::uint64_t point);
  bool isInStroke(std::uint64_t point) const {
    const std::size_t at = points_.indexOf(point);
    return at < slot_.size() && slot_[at] < open_.points.size() && open_.points[slot_[at]].number == point;
  }
  bool carryOut(HistoryChange& change, const Carriers& carriers);
  bool carryOut(PointStroke& stroke, const Carriers& carriers);
  void followInLayer(PointStroke& stroke, bool isSeen, const Carriers& carriers);
  bool carryOut(PresenceStroke& stroke, const Carriers& carriers);
  bool isOthers(std::uint64_t point, std::uint64_t received) const;

  PointStates points_;
  UndoList<HistoryChange> list_;
  PointStroke open_;                 // the stroke in progress
  std::uint64_t openVersion_ = 0;    // before it
  std::vector<std::uint32_t> slot_;  // as points_: its index in open_, if it is there
  std::uint64_t version_ = 0, lastVersion_ = 0;
  std::uint64_t received_ = 0;               // number of received batches with states of known points
  std::vector<std::uint64_t> lastReceived_;  // as points_: the last of these batches with it; 0 behind the end
  bool inStroke_ = false, keepsStroke_ = false;
  StrokeLayers* layers_ = nullptr;
  std::optional<PointSet> slid_;  // the points of the last entry, if it is a slide, which may be continued
  std::uint64_t strokes_ = 0;
};

}  // namespace palpate
