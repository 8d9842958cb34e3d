// Queues window events: a frame handles at most one press or release, so that one shorter than a frame is not lost.
#pragma once

#include <deque>
#include <set>
#include <vector>

#include "apps/view/events.hpp"

namespace palpate {

class EventQueue {
 public:
  /// Adds events that came one after another between two times.
  void add(const std::vector<WindowEvent>& events, double from_s, double to_s);
  bool isEmpty() const { return waiting_.empty(); }
  /// The events for the next frame, in order; the others stay for the frame after it.
  std::vector<TimedEvent> takeForPicture();
  /// Time before which all events were taken, of those until `now_s`.
  double known_s(double now_s) const { return waiting_.empty() ? now_s : waiting_.front().time_s; }
  /// The position under the cursor may have changed: a button press waits until frames have picked it again.
  void forgetSeen() { picturesSinceChange_ = 0; }
  bool hasSeen() const;

 private:
  // Kinds of events that this frame contains so far.
  struct Seen {
    bool moved = false, turned = false, button = false, key = false;
  };
  bool fits(const WindowEvent& event, const Seen& seen) const;
  void note(const WindowEvent& event, Seen& seen);

  std::deque<TimedEvent> waiting_;
  std::set<int> keys_;  // pressed at present
  int picturesSinceChange_ = 0;
};

}  // namespace palpate
