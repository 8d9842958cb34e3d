// The user's hands: events of the window, and what they move, i.e. the stylus, the view, the brush, an outline.
#pragma once

#include "apps/view/brush_in_hand.hpp"
#include "apps/view/event_queue.hpp"
#include "apps/view/keyboard.hpp"
#include "apps/view/pointing_devices.hpp"
#include "apps/view/select_tool.hpp"
#include "apps/view/viewer_parts.hpp"
#include "apps/view/walk.hpp"

namespace palpate {

class Hands {
 public:
  /// `listens`: use a 3D mouse, if one exists and no device is held.
  Hands(const ViewerParts& parts, bool listens) : parts_(parts), pointing_(parts.window, listens) {}

  /// Queues events that came since the last call and returns those for the next frame; none while isFinishing(). The
  /// window system does not tell when they came: they are spread over the time since the last call.
  std::vector<TimedEvent> takeEvents(const std::vector<WindowEvent>& events, double clock_s);
  /// Handles an event. Returns the commands that it means.
  ViewCommands handle(const WindowEvent& event);
  /// Whether the button is up, and the stylus still follows the path that was drawn until then: events wait for it, so
  /// that they do not change the stroke.
  bool isFinishing() const;

  /// Time of the event that is handled, or of the frame.
  void setNow(double now_s) { now_s_ = now_s; }
  double now_s() const { return now_s_; }
  /// Called once per frame: the stylus of the mouse, an outline and a measure are each of one tool.
  void followTool();
  /// Called once per frame. Between models: one that is being opened has the device of its beginning.
  void followDevice();

  bool isSculpting();
  /// The brush that held keys make of the chosen one.
  BrushSettings brushInHand();
  BrushHint brushHint();
  DrawnVolume drawnVolume();
  Pointed pointed();
  /// Returns whether the command has done something.
  bool carryOut(BrushCommand command);
  void carryOut(const WalkCommand& command) { walk_.hold(command); }
  /// Called once per frame.
  void walk(double dt_s);
  /// Whether the view moves without an event.
  bool isWalking() const { return walk_.isWalking(); }

  EventQueue& events() { return events_; }
  const EventQueue& events() const { return events_; }
  PointingDevices& pointing() { return pointing_; }
  SelectTool& select() { return select_; }
  Measure& measure() { return measure_; }

 private:
  void handle(const ButtonEvent& button, bool meansModel);
  void press(MouseButton button);
  // Returns whether the event was for the drag of the brush.
  bool dragBrush(const WindowEvent& event, bool repeats);
  void followStiffness(std::optional<double> ofDevice_N_per_mm);

  ViewerParts parts_;
  EventQueue events_;
  double now_s_ = 0, polled_s_ = 0;  // polled: time of the last look for events
  Keyboard keyboard_;
  PointingDevices pointing_;
  BrushInHand inHand_;
  SelectTool select_;
  Measure measure_;
  Walk walk_;
  std::optional<double> ownStiffness_N_per_mm_;  // for other devices; set while a remembered one applies
};

}  // namespace palpate
