// Queues window events: a frame handles at most one press or release, so that one shorter than a frame is not lost.
#pragma once

#include <deque>
#include <set>
#include <vector>

#include "apps/view/events.hpp"

namespace palpate {

class EventQueue {
 public:
  void add(const std::vector<WindowEvent>& events) { waiting_.insert(waiting_.end(), events.begin(), events.end()); }
  bool isEmpty() const { return waiting_.empty(); }
  /// The events for the next frame, in order; the others stay for the frame after it.
  std::vector<WindowEvent> takeForPicture();
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

  std::deque<WindowEvent> waiting_;
  std::set<int> keys_;  // pressed at present
  int picturesSinceChange_ = 0;
};

}  // namespace palpate
