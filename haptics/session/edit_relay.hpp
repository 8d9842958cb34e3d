// Passes the edits of a session to their followers: the picture, the history, the session log.
#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "engine/core/edit_follower.hpp"
#include "engine/core/edit_stream.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/edit/change_words.hpp"
#include "engine/edit/history.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

struct RelayOptions {
  std::vector<EditFollower*> followers;  ///< take the edits after the history
  double rate_Hz = 30;                   ///< how often edits are taken against the clock
  bool keepsPoints = false;              ///< the history follows the points
  bool isPart = false;                   ///< only a part of the cloud is known; other followers do not get its edits
  UndoBudget undo;                       ///< of the history
  SessionWriter* log = nullptr;          ///< receives the edits, if the history follows them; flushed in virtual time
};

/// Result of undo and redo after a session.
struct UndoneStrokes {
  std::uint64_t strokes = 0;  ///< of the session
  std::size_t undone = 0, redone = 0;
  std::uint64_t dropped = 0;          ///< that cannot be undone, because they exceeded the history's budget
  std::uint64_t tooLarge = 0;         ///< of them, those larger than the whole budget
  ChangeInWords last;                 ///< that was undone or redone last
  std::optional<ChangeInWords> next;  ///< that the next undo takes
};

/// Takes the edits of a back end and passes them on: between ticks in virtual time; against the clock on a thread of
/// its own, some times a second, or, in a live session, on the thread that calls catchUp(). Neither delays a tick; in
/// virtual time no edit is dropped because the relay is behind. Failures do not stop the hand: finish() throws those of
/// the thread, checkFollower() those of a follower.
class EditRelay {
 public:
  /// `attributes`: of the points of `cloud`; `edits`: null where the points are never edited; `shape`: null where no
  /// shape is. Before the first query. All arguments must outlive this object.
  EditRelay(const PointCloud& cloud, LayerAttributes& attributes, EditStream* edits, ShapeStrokes* shape,
            const RelayOptions& options);

  /// Begins. The observer is for virtual time; it is empty against the clock, or if there are no followers.
  TickObserver begin(double rate_Hz, bool realtime);
  /// Ends the thread and takes the remaining edits. Throws its failure. After the back end's own finish().
  void finish();
  /// Ends the thread; the history remains unchanged, edits may be missing.
  void stop() { thread_ = {}; }
  /// Takes the edits so far. For the session's own thread, unless begin() has started a thread that still runs.
  void catchUp();
  /// Edits taken by the last catchUp(), if the history follows the points.
  const EditBatch& batch() const { return batch_; }
  /// Replaces or removes the log that receives the edits.
  void setLog(SessionWriter* log) { options_.log = log; }
  /// The masks and fields as recorded edits: as they were after the last stroke that can be undone, then the changes
  /// since, and what of these is undone. Between strokes.
  EditBatch attributeHistory();
  /// Begins with recorded edits (followAgain()). Before the first query.
  void followAgain(const EditBatch& edits);
  /// Applies the masks in the back end. Once all edits were taken.
  void applyMasks();

  /// Null if nothing is followed.
  History* history() { return history_ ? &*history_ : nullptr; }
  const History* history() const { return history_ ? &*history_ : nullptr; }
  bool keepsPoints() const { return options_.keepsPoints; }
  /// Changes a mask, a field or a layer of strokes, which can be undone, between strokes; if memory is out, nothing has
  /// changed. Requires keepsPoints(), since new points take the masks and values of their parents.
  void change(AttributeChange change);
  /// Sets points, each once and not at the state `to` yet, to that state, as one stroke, between strokes. Throws as
  /// EditStream::change() does; then nothing has changed. Requires keepsPoints() and edits.
  void setPoints(std::span<const PointChange> changes);
  /// Removes existing points and restores others, likewise.
  void changePresence(const PointSet& points);
  /// As setPoints() of known points, many at once.
  void changeMany(BareVector<PointState> states);
  /// Gives a layer of strokes another strength, likewise: one stroke, or more of the stroke before.
  void slide(StrokeLayerChange change);
  /// Undoes up to `undo` changes and redoes up to `redo` of them, between strokes, once all edits were taken. If one
  /// fails, the history stays as after the last one that did not.
  UndoneStrokes undo(std::size_t undo, std::size_t redo);
  /// The last stroke as if it had never been made (History::takeBack()); otherwise as undo().
  bool takeBack();
  /// Throws the failure of a follower; call it once everything else is saved.
  void checkFollower() const;

 private:
  void observe(const TraceRow& row);
  // Exchanges a mask or a field; in the back end, too, if it has to know of it.
  void exchange(AttributeChange& change, EditMark::Kind kind, bool inBackEnd = true);
  void applyLock();
  void applyHidden();
  void noteLayer(StrokeLayerChange change, EditMark::Kind kind);
  History::CarryMany carryMany();
  // `kind`: of the marks; read while the carriers are used.
  History::Carriers carriers(const EditMark::Kind& kind);
  void markStroke();
  // Whether an edit log of bounded size may soon have no room for another edit.
  bool isNearlyFull() const;
  bool isHalfFull() const;

  const PointCloud& cloud_;
  LayerAttributes& attributes_;
  EditStream* edits_;
  ShapeStrokes* shape_;
  RelayOptions options_;
  std::optional<History> history_;
  EditBatch batch_;
  EditBatch changed_;          // begins the next batch
  bool endsInStroke_ = false;  // the last change of the next batch is a stroke
  bool isKnown_ = false;       // the history has the states of the last change of the next batch
  std::uint64_t ticks_ = 0, period_ = 1;
  double lastFlush_s_ = 0;
  std::exception_ptr failure_, followerFailure_;  // the first one of each
  std::jthread thread_;
};

}  // namespace palpate
