#define GLFW_INCLUDE_NONE
#include "apps/view/event_queue.hpp"

#include <GLFW/glfw3.h>

namespace palpate {

namespace {

// Frames until the position under the cursor is known: one copies the depth there, the next one reads it.
constexpr int kUntilSeen = 2;

bool isModifier(int key) { return key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER; }

}  // namespace

bool EventQueue::hasSeen() const { return picturesSinceChange_ >= kUntilSeen; }

// A key's meaning may depend on a click before it: the key waits until a frame has handled that click.
bool EventQueue::fits(const WindowEvent& event, const Seen& seen) const {
  if (std::holds_alternative<MouseEvent>(event)) return !seen.button && !seen.turned;
  if (std::holds_alternative<WheelEvent>(event)) return !seen.button && !seen.moved;
  if (const auto* button = std::get_if<ButtonEvent>(&event))
    return !seen.button && !seen.turned && !seen.key && (!button->down || hasSeen());
  if (std::holds_alternative<TextEvent>(event)) return !seen.button;
  if (const auto* key = std::get_if<KeyEvent>(&event)) {
    const bool repeats = keys_.contains(key->key) == key->down;
    return !seen.button && (repeats || !seen.key);
  }
  return true;
}

void EventQueue::note(const WindowEvent& event, Seen& seen) {
  if (std::holds_alternative<MouseEvent>(event)) seen.moved = true;
  if (std::holds_alternative<WheelEvent>(event)) seen.turned = true;
  if (seen.moved || seen.turned) forgetSeen();
  if (std::holds_alternative<ButtonEvent>(event)) seen.button = true;
  const auto* key = std::get_if<KeyEvent>(&event);
  if (!key || keys_.contains(key->key) == key->down) return;
  key->down ? void(keys_.insert(key->key)) : void(keys_.erase(key->key));
  // Modifiers such as Ctrl have no effect alone.
  seen.key = seen.key || !isModifier(key->key);
}

void EventQueue::add(const std::vector<WindowEvent>& events, double from_s, double to_s) {
  const double gap_s = (to_s - from_s) / static_cast<double>(events.size() + 1);
  for (const WindowEvent& event : events) waiting_.push_back({from_s += gap_s, event});
}

std::vector<TimedEvent> EventQueue::takeForPicture() {
  std::vector<TimedEvent> taken;
  Seen seen;
  if (!hasSeen()) ++picturesSinceChange_;
  while (!waiting_.empty() && fits(waiting_.front().event, seen)) {
    note(waiting_.front().event, seen);
    taken.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return taken;
}

}  // namespace palpate
