// What a session does to the points goes to whoever follows it: the picture, the journal, the session log.
#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "engine/core/edit_follower.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/edit/journal.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

struct RelayOptions {
  std::vector<EditFollower*> followers;  ///< null: nobody
  double rate_Hz = 30;                   ///< how often edits are taken against the clock
  bool journal = false;
  std::uint64_t undo_bytes = 0;  ///< the journal's budget for strokes
  SessionWriter* log = nullptr;  ///< is given the edits, with a journal; and flushed in virtual time
};

/// Takes edits from a back end and passes them on: between ticks in virtual time, and on a thread of its own against
/// the wall clock, some times a second. Nobody waits for it there; in virtual time no edit is left out because it is
/// behind. A failure on its thread waits for finish(), one of the follower for checkFollower(), since the hand goes
/// first.
class EditRelay {
 public:
  /// Before the first query. All arguments outlive this.
  EditRelay(const PointCloud& cloud, TouchBackend& backend, const RelayOptions& options);

  /// Begins: the observer is for virtual time and empty against the clock, or where nobody follows.
  TickObserver begin(double rate_Hz, bool realtime);
  /// Ends the thread and catches up. Throws what went wrong there. After the back end's own finish().
  void finish();
  /// Ends the thread: the journal stays as it is, however far it has come.
  void stop() { thread_ = {}; }
  /// In the session's own thread, where begin() has started none, or it has ended: takes in what has been done.
  void catchUp();
  /// What the last catchUp() took in, where there is a journal.
  const EditBatch& batch() const { return batch_; }
  /// Another log, or none, is given the edits from now on.
  void setLog(SessionWriter* log) { options_.log = log; }

  Journal* journal() { return journal_ ? &*journal_ : nullptr; }
  const Journal* journal() const { return journal_ ? &*journal_ : nullptr; }
  /// Throws what went wrong with the follower; ask once all else is saved.
  void checkFollower() const;

 private:
  void observe(const TraceRow& row);
  // An edit log of bounded size may soon have no room for another edit.
  bool isNearlyFull() const;
  bool isHalfFull() const;

  std::size_t points_;
  TouchBackend& backend_;
  RelayOptions options_;
  std::optional<Journal> journal_;
  EditBatch batch_;
  std::uint64_t ticks_ = 0, period_ = 1;
  double lastFlush_s_ = 0;
  std::exception_ptr failure_, followerFailure_;  // the first one of each
  std::jthread thread_;
};

/// What came of undo and redo after a session.
struct UndoneStrokes {
  std::uint64_t strokes = 0;  ///< of the session
  std::size_t undone = 0, redone = 0;
  std::uint64_t dropped = 0;   ///< that could not be undone any more, for the journal's budget
  std::uint64_t tooLarge = 0;  ///< of them, those larger than all of it
};
/// Undoes `undo` strokes and redoes `redo` of them, as far as there are any. `catchUp` lets the journal take in what
/// the back end has done; all of it so far has been. Between strokes. Where the back end throws, the journal is left as
/// the last change that came out has left the points.
UndoneStrokes undoStrokes(TouchBackend& backend, Journal& journal, const std::function<void()>& catchUp,
                          std::size_t undo, std::size_t redo);
/// The same of strokes that have changed a shape.
UndoneStrokes undoStrokes(ShapeStrokes& shape, std::size_t undo, std::size_t redo);

}  // namespace palpate
