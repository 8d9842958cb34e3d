// Mouse, gamepad and 3D mouse: they move the viewpoint, or the stylus while one of them holds it.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "apps/view/camera_drag.hpp"
#include "apps/view/events.hpp"
#include "apps/view/measure.hpp"
#include "apps/view/requests.hpp"
#include "apps/view/space_mouse.hpp"
#include "apps/view/stylus_hand.hpp"
#include "apps/view/viewpoint.hpp"

namespace palpate {

class Messages;
class Window;

/// What they point at.
struct Pointed {
  WindowSession* session = nullptr;  ///< null: no model is open
  Viewpoint& viewpoint;
  Pick picked;
  DVec2 size_px{0};
  double time_s = 0;
  Measure* measure = nullptr;  ///< that the left button picks places for; null: it turns the view
};

class PointingDevices {
 public:
  /// A device in a person's hand is the stylus. `listens`: to a 3D mouse, if there is one, and nobody holds a device.
  PointingDevices(Window& window, const LiveOptions& held, bool listens);

  const std::string& deviceName() const { return deviceName_; }  ///< empty: a person holds none
  const DVec2& cursor_px() const { return cursor_px_; }
  bool holdsStylus() const { return hand_.isHeld(); }
  bool isTouching() const { return hand_.isHeld() || device_; }  ///< with the stylus, or a device
  bool isMoving() const { return hand_.isHeld() || drag_.isUnderWay(); }
  std::uint64_t presses() const { return presses_; }  ///< of the stylus so far
  bool isPressing() const { return hand_.isHeld() && hand_.isPressing(); }
  /// Whether the button was let go before the hand has reached the surface: it goes on until it has left its mark.
  bool isTapping() const { return tapping_; }

  void moveMouse(const DVec2& place_px, const Pointed& at);
  void press(MouseButton button, bool shift, const Pointed& at);
  void release(MouseButton button, const Pointed& at);
  /// Whether a click has meant to measure since the last call, and met nothing.
  bool takeMiss() { return std::exchange(hasMissed_, false); }
  void turnWheel(const WheelEvent& event, const Pointed& at);
  /// What the cap of a 3D mouse has done since the last call.
  std::optional<PushEvent> takePush(Messages& messages);
  /// What its buttons ask for; the cap is heeded by move().
  ViewRequests push(const PushEvent& event, const Pointed& at);

  void carryOut(StylusRequest request, const Pointed& at);
  /// Another model comes.
  void letGo(const Pointed& at);
  /// Once for each picture, `dt_s` after the last one: what is held moves on, and the stylus goes where it points.
  void move(double dt_s, const ViewSettings& view, const Pointed& at);

 private:
  void hold(bool on, WindowSession* session);
  void moveByPad(double dt_s, const Pointed& at);
  void moveByCap(double dt_s, const Pointed& at);
  void aimAt(const DVec3& place, const ViewSettings& view, const Pointed& at);
  bool hasLeftNothing(const Pointed& at) const;
  void moveCursor(const DVec2& way_px, const Pointed& at);
  std::optional<DVec3> placeUnderCursor(const Pointed& at) const;

  Window& window_;
  std::shared_ptr<TurnedDevice> device_;
  std::string deviceName_;
  DVec2 cursor_px_{0};
  std::optional<DVec2> missed_px_;  // where a button went down beside the model, to measure
  bool hasMissed_ = false;
  CameraDrag drag_;
  StylusHand hand_;
  std::optional<DVec3> pressedAt_;  // of the surface, where it pressed last; model units
  bool wasBeside_ = false;          // and whether that was beside the model
  double felt_s_ = 0;               // when it was put down, or has felt the surface since
  struct {
    double time_s = 0;
    std::uint64_t edits = 0;
  } pressed_;  // when the stylus was pressed, and what had been sculpted by then
  bool tapping_ = false;
  PushEvent push_;
  std::uint64_t presses_ = 0;
  std::optional<SpaceMouse> spaceMouse_;
};

}  // namespace palpate
