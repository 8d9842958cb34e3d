// Who follows what a session does to the points: the picture, the journal, the session log.
#pragma once

#include <thread>

#include "apps/model.hpp"
#include "engine/edit/journal.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

struct FollowersWanted {
  bool picture = false;  ///< kept up to date while the session lasts, where the back end is Vulkan's
  bool journal = false;
  std::uint64_t undo_bytes = 0;  ///< the journal's budget for strokes
  Device* sight = nullptr;       ///< where the picture is kept; the touched cloud's own GPU when not given
  SessionWriter* log = nullptr;  ///< is given the edits, with a journal; and flushed in virtual time
};

/// They follow between ticks in virtual time and on a thread of their own against the wall clock, 30 times a second.
/// Nobody waits for them there; in virtual time no edit is left out because they are behind. A failure on their thread
/// waits for finish(), one of the picture for drawn(), since the hand goes first.
class Followers {
 public:
  /// Before the first query. All arguments outlive this.
  Followers(Context& context, const Model& model, TouchBackend& backend, const FollowersWanted& wanted);

  /// Begins to follow: the observer is for virtual time and empty against the clock, or where nobody follows.
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
  void setLog(SessionWriter* log) { log_ = log; }

  Journal* journal() { return journal_ ? &*journal_ : nullptr; }
  /// Throws what went wrong while the picture was kept up to date; ask once all else is saved.
  DrawnCloud* drawn();

 private:
  void draw();
  void observe(const TraceRow& row);
  // The ring of a GPU may soon have no room for another edit.
  bool isNearlyFull() const;
  bool isHalfFull() const;

  const Model& model_;
  TouchBackend& backend_;
  SessionWriter* log_;
  TouchSide* touchSide_;  // where it is one
  bool byHost_ = false;   // the picture is told of edits through the host
  std::optional<DrawnCloud> drawn_;
  std::optional<EditLog::Reader> drawnReader_;
  std::optional<Journal> journal_;
  EditBatch batch_;
  std::uint64_t ticks_ = 0, period_ = 1;
  double lastFlush_s_ = 0;
  std::exception_ptr failure_, drawingFailure_;
  std::jthread thread_;
};

/// What came of undo and redo after a session.
struct StrokesTakenBack {
  std::uint64_t strokes = 0;  ///< of the session
  std::size_t undone = 0, redone = 0;
  std::uint64_t dropped = 0;   ///< that could not be undone any more, for the journal's budget
  std::uint64_t tooLarge = 0;  ///< of them, those larger than all of it
};
/// Takes `undo` strokes back and does `redo` of them again, as far as there are any. `follow` lets the journal take in
/// what the back end tells; all it told so far has been. Between strokes. Where the back end throws, the journal is
/// left as the last change that came out has left the points.
StrokesTakenBack takeBack(TouchBackend& backend, Journal& journal, const std::function<void()>& follow,
                          std::size_t undo, std::size_t redo);

}  // namespace palpate
