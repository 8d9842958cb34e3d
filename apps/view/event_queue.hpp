// Events on their way from the window to what they mean: a picture sees at most one change of what is pressed, so that
// none is lost that is shorter than a picture.
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
  /// Those that the next picture is to see, in order; the others wait for the picture behind it.
  std::vector<WindowEvent> takeForPicture();
  /// Something else may be under the cursor: a button that goes down waits until pictures have shown what.
  void forgetSeen() { picturesSinceChange_ = 0; }
  bool hasSeen() const;

 private:
  // What the picture has seen so far.
  struct Seen {
    bool moved = false, turned = false, button = false, key = false;
  };
  bool fits(const WindowEvent& event, const Seen& seen) const;
  void note(const WindowEvent& event, Seen& seen);

  std::deque<WindowEvent> waiting_;
  std::set<int> keys_;  // that are down
  int picturesSinceChange_ = 0;
};

}  // namespace palpate
