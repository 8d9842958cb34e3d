// Mouse, gamepad and 3D mouse: they move the viewpoint, or the stylus while it is held.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "apps/view/camera_drag.hpp"
#include "apps/view/commands.hpp"
#include "apps/view/events.hpp"
#include "apps/view/measure.hpp"
#include "apps/view/space_mouse.hpp"
#include "apps/view/stylus_hand.hpp"
#include "apps/view/viewpoint.hpp"

namespace palpate {

class Messages;
class Window;

/// The target of the pointing devices.
struct Pointed {
  WindowSession* session = nullptr;  ///< null: no model is open
  Viewpoint& viewpoint;
  Pick picked;
  DVec2 size_px{0};
  double time_s = 0;                      ///< of the event, or of the frame
  std::function<FoundSurface()> surface;  ///< reads that of the last picture
  Measure* measure = nullptr;  ///< the left button picks positions for it; null: the left button rotates the view
  bool waits = false;          ///< the model is parked: the stylus may be held, and touches it once it answers
};

class PointingDevices {
 public:
  /// `listens`: use a 3D mouse, if one exists and no device is held.
  PointingDevices(Window& window, bool listens);

  /// A haptic device that is the stylus from now on; null: the mouse is.
  void setDevice(std::shared_ptr<TurnedDevice> device, const Pointed& at);
  const DVec2& cursor_px() const { return cursor_px_; }
  bool holdsStylus() const { return hand_.isHeld(); }
  bool isTouching() const { return hand_.isHeld() || device_; }  ///< with the stylus, or a device
  /// Whether the stylus, or a pad that moves without events, may move at any time.
  bool mayMove() const;
  std::uint64_t presses() const { return presses_; }  ///< number of presses of the stylus

  void moveMouse(const DVec2& place_px, const Pointed& at);
  void press(MouseButton button, bool shift, const ViewSettings& view, const Pointed& at);
  /// A drag that turns the camera where it is.
  void beginTurn() { drag_.beginTurn(); }
  void release(MouseButton button, const Pointed& at);
  /// Whether a click to measure has missed the model since the last call.
  bool takeMiss() { return std::exchange(hasMissed_, false); }
  void turnWheel(const WheelEvent& event, const Pointed& at);
  /// The state of the 3D mouse, if it has changed since the last call.
  std::optional<PushEvent> takePush(Messages& messages);
  /// Commands of its buttons; the cap takes effect in move().
  ViewCommands push(const PushEvent& event, const Pointed& at);

  void carryOut(StylusCommand command, const Pointed& at);
  /// Ends drag and stroke: the model does not answer for a while.
  void endStroke(const Pointed& at);
  /// The model answers again: the stylus begins in front of its surface.
  void putDownAgain() { hand_.putDownAgain(); }
  /// Releases stylus and drag, e.g. before another model is opened.
  void letGo(const Pointed& at);
  /// Called once per frame, `dt_s` after the last one: applies held sticks and cap, and aims the stylus at the cursor.
  void move(double dt_s, const ViewSettings& view, const Pointed& at);

 private:
  void hold(bool on, const Pointed& at);
  void moveByPad(double dt_s, const Pointed& at);
  void moveByCap(double dt_s, const Pointed& at);
  void beginStroke(const ViewSettings& view, const Pointed& at);
  void aimAt(const DVec3& place, const ViewSettings& view, const Pointed& at);
  void moveCursor(const DVec2& way_px, const Pointed& at);
  std::optional<DVec3> placeUnderCursor(const Pointed& at) const;

  Window& window_;
  std::shared_ptr<TurnedDevice> device_;
  DVec2 cursor_px_{0};
  std::optional<DVec2> missed_px_;  // cursor at a press to measure that missed the model
  bool hasMissed_ = false;
  CameraDrag drag_;
  StylusHand hand_;
  PushEvent push_;
  std::uint64_t presses_ = 0;
  std::optional<SpaceMouse> spaceMouse_;
};

}  // namespace palpate
