// Passes the edits of a session to their followers: the picture, the journal, the session log.
#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "engine/core/edit_follower.hpp"
#include "engine/core/edit_stream.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/edit/journal.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

struct RelayOptions {
  std::vector<EditFollower*> followers;  ///< take the edits after the journal
  double rate_Hz = 30;                   ///< how often edits are taken against the clock
  bool journal = false;
  std::uint64_t undo_bytes = 0;  ///< the journal's budget for strokes
  SessionWriter* log = nullptr;  ///< receives the edits, if there is a journal; flushed in virtual time
};

/// Takes the edits of a back end and passes them on: between ticks in virtual time; against the clock on a thread of
/// its own, some times a second, or, in a live session, on the thread that calls catchUp(). Neither delays a tick; in
/// virtual time no edit is dropped because the relay is behind. Failures do not stop the hand: finish() throws those of
/// the thread, checkFollower() those of a follower.
class EditRelay {
 public:
  /// `edits`: null where the points are never edited. Before the first query. All arguments must outlive this object.
  EditRelay(const PointCloud& cloud, EditStream* edits, const RelayOptions& options);

  /// Begins. The observer is for virtual time; it is empty against the clock, or if there are no followers.
  TickObserver begin(double rate_Hz, bool realtime);
  /// Ends the thread and takes the remaining edits. Throws its failure. After the back end's own finish().
  void finish();
  /// Ends the thread; the journal remains unchanged, edits may be missing.
  void stop() { thread_ = {}; }
  /// Takes the edits so far. For the session's own thread, unless begin() has started a thread that still runs.
  void catchUp();
  /// Edits taken by the last catchUp(), if there is a journal.
  const EditBatch& batch() const { return batch_; }
  /// Replaces or removes the log that receives the edits.
  void setLog(SessionWriter* log) { options_.log = log; }

  Journal* journal() { return journal_ ? &*journal_ : nullptr; }
  const Journal* journal() const { return journal_ ? &*journal_ : nullptr; }
  /// Throws the failure of a follower; call it once everything else is saved.
  void checkFollower() const;

 private:
  void observe(const TraceRow& row);
  // Whether an edit log of bounded size may soon have no room for another edit.
  bool isNearlyFull() const;
  bool isHalfFull() const;

  std::size_t points_;
  EditStream* edits_;
  RelayOptions options_;
  std::optional<Journal> journal_;
  EditBatch batch_;
  std::uint64_t ticks_ = 0, period_ = 1;
  double lastFlush_s_ = 0;
  std::exception_ptr failure_, followerFailure_;  // the first one of each
  std::jthread thread_;
};

/// Result of undo and redo after a session.
struct UndoneStrokes {
  std::uint64_t strokes = 0;  ///< of the session
  std::size_t undone = 0, redone = 0;
  std::uint64_t dropped = 0;   ///< that cannot be undone, because they exceeded the journal's budget
  std::uint64_t tooLarge = 0;  ///< of them, those larger than the whole budget
};
/// Undoes up to `undo` strokes and redoes up to `redo` of them, between strokes. `catchUp` lets the journal take the
/// edits; it must have taken all of them before. If a change fails, the journal stays as after the last
/// successful change.
UndoneStrokes undoStrokes(EditStream& edits, Journal& journal, const std::function<void()>& catchUp, std::size_t undo,
                          std::size_t redo);
/// The same for strokes that have changed a shape.
UndoneStrokes undoStrokes(ShapeStrokes& shape, std::size_t undo, std::size_t redo);

}  // namespace palpate
